/* SPDX-License-Identifier: Apache-2.0 */
/* Claims about boundary and volume. If the boundary is the model's surface, it is matched with it
 * (verify/boundary.c), and the volumes agree; if it only approximates the surface, the distance is
 * measured (verify/nearness.c). Either way the pieces fill what the model encloses, as far as
 * points show (verify/enclosed.c). */
#include <math.h>

#include "verify/pieces.h"

static const double TOLERANCE = 1e-9; /* relative */

/* Relative to the diagonal: larger distances do not count as near. A surface winds only around
 * points of its convex hull, which are hardly farther from it. */
static const double FARTHEST = 0.5;

static const double MUCH = 4; /* times what was measured: nowhere is the boundary so far away */

/* ---- the boundary ---- */

static void claim_on_model(const verify_context *own, const verify_match *match) {
    size_t count = own->pieces->outer->face_count;
    static const char claim[] = "the boundary lies on the model's surface and looks its way";
    if (match->off > 0)
        verify_claim(own->verdict, false, "%s: %zu of %zu faces lie elsewhere, first %s", claim,
                     match->off, count, verify_outer_words(own, match->first_off).text);
    else if (match->turned > 0)
        verify_claim(own->verdict, false, "%s: %zu of %zu faces look the other way, first %s",
                     claim, match->turned, count,
                     verify_outer_words(own, match->first_turned).text);
    else
        verify_claim(own->verdict, true, "%s: %zu faces are faces of the model, %zu parts of them",
                     claim, match->equal, count - match->equal);
}

static void claim_covered(const verify_context *own, const verify_match *match) {
    int scale = own->pieces->scale;
    if (match->uneven == 0)
        verify_claim(own->verdict, true,
                     "the boundary covers each of the model's %zu shells once (area %.9g)",
                     match->shells, ldexp(match->area, -2 * scale));
    else
        verify_claim(own->verdict, false,
                     "the boundary covers each of the model's %zu shells once: not so for %zu, "
                     "first that of face %zu, of area %.9g, covered %.9g",
                     match->shells, match->uneven, match->shell,
                     ldexp(match->shell_area, -2 * scale), ldexp(match->shell_covered, -2 * scale));
}

static void claim_near(const verify_context *own, const verify_nearness *nearness) {
    const starg_pieces_report *report = own->report;
    double rounding = verify_rounding(own->model);
    double most = FARTHEST * verify_diagonal(own->model);
    double limit = report->distance;
    bool told = report->distance_back != INFINITY;
    if (nearness->to.farthest <= limit * (1 + TOLERANCE) + rounding)
        verify_claim(own->verdict, true,
                     "the boundary is at most %.9g from the model's surface (%.9g at %zu points)",
                     limit, nearness->to.farthest, nearness->to.points);
    else
        verify_claim(own->verdict, false,
                     "the boundary is at most %.9g from the model's surface: %s is %.9g away",
                     limit, verify_outer_words(own, nearness->to.face).text, nearness->to.farthest);
    verify_claim(own->verdict,
                 !(limit > most) && nearness->from.farthest <= most &&
                     !(told && report->distance_back > most),
                 "boundary and model are the same but for a part of the diagonal: %.9g and %.9g "
                 "are at most %.9g, half of it",
                 limit, told ? report->distance_back : nearness->from.farthest, most);
    verify_leave(own->verdict, "points of either surface between those that were measured");
    if (!told)
        return;
    limit = report->distance_back;
    verify_claim(own->verdict, nearness->from.farthest <= limit * (1 + TOLERANCE) + rounding,
                 "the model's surface is at most %.9g from the boundary (%.9g at %zu points, in "
                 "face %zu)",
                 limit, nearness->from.farthest, nearness->from.points, nearness->from.face);
}

static void claim_simple(const verify_context *own, const verify_nearness *nearness) {
    if (nearness->crossings == 0)
        verify_claim(own->verdict, true, "no two faces of the boundary pass through one another");
    else
        verify_claim(own->verdict, false,
                     "no two faces of the boundary pass through one another: %zu pairs do, first "
                     "%s and one of tetrahedron %u",
                     nearness->crossings, verify_outer_words(own, nearness->pair[0]).text,
                     own->pieces->outer_facets[nearness->pair[1]] / 4);
    if (nearness->multiple == 0)
        verify_claim(own->verdict, true,
                     "the boundary winds once around the inside of its %zu shells",
                     nearness->shells);
    else
        verify_claim(own->verdict, false,
                     "the boundary winds once around the inside of its %zu shells: not so for "
                     "%zu, first behind %s",
                     nearness->shells, nearness->multiple,
                     verify_outer_words(own, nearness->shell).text);
}

/* ---- volume ---- */

static void claim_volume(const verify_context *own) {
    const verify_surface *model = own->model;
    int scale = own->pieces->scale;
    verify_volume tetrahedra = {0}, solid = {0};
    double center[3], area = 0;
    for (int k = 0; k < 3; k++)
        center[k] = model->lower[k] / 2 + model->upper[k] / 2;
    for (size_t t = 0; t < own->mesh->count; t++)
        verify_add_tetrahedron(&tetrahedra, own->mesh, t, scale);
    for (size_t f = 0; f < model->face_count; f++) {
        const double *t[4] = {center};
        verify_corners(model, f, t + 1);
        verify_add_volume(&solid, t, scale);
        area += verify_area(model, f, scale);
    }
    double expected = verify_volume_value(&solid);
    double slack = solid.slack + area * ldexp(verify_rounding(model), scale);
    verify_claim(own->verdict, verify_same_volume(&tetrahedra, expected, slack),
                 "the tetrahedra have the volume of the model (%.9g and %.9g)",
                 ldexp(verify_volume_value(&tetrahedra), -3 * scale), ldexp(expected, -3 * scale));
}

/* What is so near to the model's surface that rounding decides. */
static double skin_of(const verify_context *own) {
    return TOLERANCE * verify_diagonal(own->model) + verify_rounding(own->model);
}

/* Beyond `near` of the model's surface the two are the same. If that is more than rounding, what
 * was measured may be less than what there is: then a hundredth of the points may be wrong. */
static void claim_enclosed(const verify_context *own, const verify_enclosed *found, double near) {
    size_t wrong = found->missing + found->excess;
    size_t most = near > skin_of(own) ? found->inside / 100 : 0;
    if (own->solid == NULL)
        verify_leave(own->verdict, "the volume: the model is not closed");
    else if (wrong <= most)
        verify_claim(own->verdict, true,
                     "the pieces fill what the model encloses, once (%zu points, %zu inside)",
                     found->points, found->inside);
    else
        verify_claim(own->verdict, false,
                     "the pieces fill what the model encloses, once: of %zu points %zu inside the "
                     "model are in no piece, %zu others are in a piece or in several, for instance "
                     "(%g, %g, %g)",
                     found->points, found->missing, found->excess, found->place[0], found->place[1],
                     found->place[2]);
}

static starg_status compare_enclosed(const verify_context *own, double near,
                                     verify_enclosed *found) {
    *found = (verify_enclosed){0};
    return own->solid == NULL
               ? STARG_OK
               : verify_compare_enclosed(own->pieces, own->solid, near + skin_of(own), found);
}

/* ---- public function ---- */

static starg_status claim_nearness(const verify_context *own) {
    verify_nearness nearness;
    verify_enclosed enclosed;
    TRY(verify_measure_boundary(own->pieces, own->model, &nearness));
    const double near = fmin(own->report->distance, MUCH * nearness.to.farthest);
    TRY(compare_enclosed(own, near, &enclosed));
    claim_near(own, &nearness);
    claim_simple(own, &nearness);
    claim_enclosed(own, &enclosed, near);
    return STARG_OK;
}

/* Where solids overlap or share a wall, not all of the surface is boundary. Without a report, which
 * would tell, the pieces must have the volume, or, where the model winds more than once about some
 * points, fill what it encloses. */
static starg_status claim_match(const verify_context *own) {
    verify_match match;
    verify_enclosed enclosed;
    TRY(verify_match_surfaces(own->pieces->outer, own->model, &match));
    TRY(compare_enclosed(own, 0, &enclosed));
    claim_on_model(own, &match);
    const bool all = own->report != NULL || match.uneven == 0;
    if (all) {
        claim_covered(own, &match);
    } else {
        verify_leave(own->verdict, "what of the model's surface is not boundary");
        TRY(verify_claim_once(own));
    }
    if (all || enclosed.overlapping == 0)
        claim_volume(own);
    claim_enclosed(own, &enclosed, 0);
    return STARG_OK;
}

starg_status verify_claim_once(const verify_context *own) {
    verify_nearness nearness;
    starg_status status = verify_measure_boundary(own->pieces, own->pieces->outer, &nearness);
    if (status == STARG_OK)
        claim_simple(own, &nearness);
    return status;
}

starg_status verify_claim_boundary(const verify_context *own) {
    bool approximated = own->report != NULL && own->report->approximated;
    return approximated ? claim_nearness(own) : claim_match(own);
}
