/* Verification of a star decomposition: facts are found one after the other, and every claim is
 * held against them. Nothing is shared with what makes decompositions.
 *
 * What the claims prove together, for a model whose surface is embedded:
 *  1. Tetrahedra are positive, and a triangle is shared by two at most, on opposite sides. So a
 *     point off all triangles lies in as many tetrahedra as the outer boundary winds around it.
 *  2. The outer boundary is the model's surface, covered once (verify/boundary.c). So the number is
 *     one inside the model and zero outside: the tetrahedra fill it and do not overlap, and each
 *     belongs to one piece by its label.
 *  3. The walls of each piece are closed (verify/facets.c), its guard is strictly on the inner side
 *     of all of them, and they wind around it once (verify/certificate.c): the piece is star-shaped
 *     about its guard, which lies in the interior of its kernel.
 * Signs are exact. "On the model's surface" is within a billionth of the diagonal, so overlap is
 * ruled out but for a skin that thin. Edges that hang on the faces of others leave triangles alone
 * that then show up in the outer boundary, off the model.
 *
 * Cost: O(n) for all that concerns tetrahedra, O(n log n) for the boundary. */
#include <math.h>
#include <stdio.h>

#include "core/memory.h"
#include "verify/boundary.h"
#include "verify/claims.h"
#include "verify/measure.h"
#include "verify/pieces.h"
#include "verify/signs.h"

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-9; /* relative; for volumes and fractions */

enum { CANCEL_STEP = 1 << 16 };

typedef struct hearing {
    starg_context *context;
    const starg_pieces_mesh *mesh;
    const starg_pieces_report *report; /* or NULL */
    const verify_surface *model;
    verify_pieces *pieces;
    verify_certificate *certificates;
    starg_verdict *verdict;
} hearing;

/* ---- the input ---- */

/* Files have been checked while they were read; arrays of a caller have not. */
static starg_status check_arrays(starg_context *context, const starg_pieces_mesh *mesh) {
    if (mesh->count == 0 || mesh->count > VERIFY_TETRAHEDRA)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "%zu tetrahedra are none, or more than 2^29", mesh->count);
    for (size_t i = 0; i < 4 * mesh->count; i++)
        if (mesh->tetrahedra[i] >= mesh->vertex_count) {
            const uint64_t t = i / 4;
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_TETRAHEDRON,
                                 &t, 1, "tetrahedron %zu names vertex %u of %zu", i / 4,
                                 mesh->tetrahedra[i], mesh->vertex_count);
        }
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (!(fabs(mesh->vertices[i]) < 1e100)) {
            const uint64_t v = i / 3;
            return starg_fail_at(context, STARG_ERROR_RANGE, STAGE, STARG_ELEMENT_VERTEX, &v, 1,
                                 "vertex %zu is not finite, or not below 1e100 in magnitude",
                                 i / 3);
        }
    return STARG_OK;
}

/* ---- words for elements ---- */

typedef struct words {
    char text[96];
} words;

static words facet_words(const hearing *own, uint32_t facet) {
    words name;
    uint32_t v[3];
    verify_facet_corners(own->mesh->tetrahedra, facet, v);
    snprintf(name.text, sizeof name.text, "face %u-%u-%u of tetrahedron %u", v[0], v[1], v[2],
             facet / 4);
    return name;
}

static words outer_words(const hearing *own, size_t face) {
    return facet_words(own, own->pieces->outer_facets[face]);
}

/* ---- tetrahedra ---- */

static starg_status claim_positive(const hearing *own) {
    starg_status status = STARG_OK;
    const starg_pieces_mesh *mesh = own->mesh;
    size_t bad = 0, first = 0;
    for (size_t t = 0; t < mesh->count; t++) {
        const uint32_t *v = mesh->tetrahedra + 4 * t;
        if (t % CANCEL_STEP == 0)
            STARG_TRY(starg_check_cancel(own->context, STAGE));
        if (verify_side(verify_point(mesh, v[0]), verify_point(mesh, v[2]),
                        verify_point(mesh, v[1]), verify_point(mesh, v[3])) <= 0 &&
            bad++ == 0)
            first = t;
    }
    if (bad == 0)
        verify_claim(own->verdict, true, "all %zu tetrahedra are positive", mesh->count);
    else
        verify_claim(own->verdict, false,
                     "all %zu tetrahedra are positive: %zu are inverted or flat, first "
                     "tetrahedron %zu of piece %d",
                     mesh->count, bad, first, mesh->labels[first]);
done:
    return status;
}

static void claim_conforming(const hearing *own) {
    static const char claim[] = "each triangle has one tetrahedron, or two on opposite sides";
    const verify_misuse *third = &own->pieces->facets->third;
    const verify_misuse *same = &own->pieces->facets->same_side;
    if (third->count > 0)
        verify_claim(own->verdict, false, "%s: %zu have more, first %s", claim, third->count,
                     facet_words(own, third->facet).text);
    else if (same->count > 0)
        verify_claim(own->verdict, false,
                     "%s: %zu have two on one side, first %s, also of tetrahedron %u", claim,
                     same->count, facet_words(own, same->facet).text, same->other / 4);
    else
        verify_claim(own->verdict, true, "%s", claim);
}

static void claim_labels(const hearing *own) {
    const verify_labels *labels = &own->pieces->labels;
    size_t count = own->pieces->piece_count;
    if (labels->tetrahedron != VERIFY_NONE)
        verify_claim(
            own->verdict, false, "labels name the pieces 0 to %zu: tetrahedron %zu has label %d",
            count - (count > 0), labels->tetrahedron, own->mesh->labels[labels->tetrahedron]);
    else if (!labels->good)
        verify_claim(own->verdict, false,
                     "labels name the pieces 0 to %zu: %zu are empty, first piece %zu", count - 1,
                     labels->empty, labels->first);
    else
        verify_claim(own->verdict, true, "labels name the pieces 0 to %zu, and none is empty",
                     count - 1);
}

static void claim_size(const hearing *own) {
    verify_claim(own->verdict, own->report->tetrahedra == own->mesh->count,
                 "there are %zu tetrahedra (the file holds %zu)", own->report->tetrahedra,
                 own->mesh->count);
}

/* ---- the boundary ---- */

static void claim_on_model(const hearing *own, const verify_match *match) {
    size_t count = own->pieces->outer->face_count;
    static const char claim[] = "the boundary lies on the model's surface and looks its way";
    if (match->off > 0)
        verify_claim(own->verdict, false, "%s: %zu of %zu faces lie elsewhere, first %s", claim,
                     match->off, count, outer_words(own, match->first_off).text);
    else if (match->turned > 0)
        verify_claim(own->verdict, false, "%s: %zu of %zu faces look the other way, first %s",
                     claim, match->turned, count, outer_words(own, match->first_turned).text);
    else
        verify_claim(own->verdict, true, "%s: %zu faces are faces of the model, %zu parts of them",
                     claim, match->equal, count - match->equal);
}

static void claim_covered(const hearing *own, const verify_match *match) {
    int scale = own->pieces->scale;
    if (match->uneven == 0)
        verify_claim(own->verdict, true,
                     "the boundary covers each of the model's %zu shells once (area %.17g)",
                     match->shells, ldexp(match->area, -2 * scale));
    else
        verify_claim(own->verdict, false,
                     "the boundary covers each of the model's %zu shells once: not so for %zu, "
                     "first that of face %zu, of area %.17g, covered %.17g",
                     match->shells, match->uneven, match->shell,
                     ldexp(match->shell_area, -2 * scale), ldexp(match->shell_covered, -2 * scale));
}

static void claim_near(const hearing *own, const verify_nearness *nearness) {
    double limit = own->report->distance;
    bool near = nearness->farthest <= limit * (1 + TOLERANCE) + verify_rounding(own->model);
    if (near)
        verify_claim(own->verdict, true,
                     "the boundary is at most %.17g from the model's surface (%.17g at %zu points)",
                     limit, nearness->farthest, nearness->points);
    else
        verify_claim(own->verdict, false,
                     "the boundary is at most %.17g from the model's surface: %s is %.17g away",
                     limit, outer_words(own, nearness->face).text, nearness->farthest);
}

static void claim_simple(const hearing *own, const verify_nearness *nearness) {
    if (nearness->crossings == 0)
        verify_claim(own->verdict, true, "no two faces of the boundary pass through one another");
    else
        verify_claim(own->verdict, false,
                     "no two faces of the boundary pass through one another: %zu pairs do, first "
                     "%s and one of tetrahedron %u",
                     nearness->crossings, outer_words(own, nearness->first).text,
                     own->pieces->outer_facets[nearness->second] / 4);
    if (nearness->multiple == 0)
        verify_claim(own->verdict, true,
                     "the boundary winds once around the inside of its %zu shells",
                     nearness->shells);
    else
        verify_claim(own->verdict, false,
                     "the boundary winds once around the inside of its %zu shells: not so for "
                     "%zu, first behind %s",
                     nearness->shells, nearness->multiple, outer_words(own, nearness->shell).text);
}

static starg_status claim_boundary(const hearing *own) {
    starg_status status = STARG_OK;
    if (own->report != NULL && own->report->approximated) {
        verify_nearness nearness;
        STARG_TRY(verify_measure_boundary(own->pieces, own->model, &nearness));
        claim_near(own, &nearness);
        claim_simple(own, &nearness);
    } else {
        verify_match match;
        STARG_TRY(verify_match_boundary(own->pieces, own->model, &match));
        claim_on_model(own, &match);
        claim_covered(own, &match);
    }
done:
    return status;
}

/* ---- volume ---- */

/* A volume in scaled units, and how far rounding may have moved it. */
typedef struct volume {
    verify_total sum;
    double slack;
} volume;

static void add_volume(volume *own, const double *const t[4], int scale) {
    double box = 1;
    for (int k = 0; k < 3; k++) {
        double lower = fmin(fmin(t[0][k], t[1][k]), fmin(t[2][k], t[3][k]));
        double upper = fmax(fmax(t[0][k], t[1][k]), fmax(t[2][k], t[3][k]));
        box *= ldexp(upper - lower, scale);
    }
    verify_total_add(&own->sum, verify_volume(t[0], t[1], t[2], t[3], scale));
    own->slack += 0x1p-48 * box;
}

static void add_tetrahedron(volume *own, const hearing *h, size_t tetrahedron) {
    const double *t[4];
    for (size_t i = 0; i < 4; i++)
        t[i] = verify_point(h->mesh, h->mesh->tetrahedra[4 * tetrahedron + i]);
    add_volume(own, t, h->pieces->scale);
}

static bool same_volume(const volume *a, double b, double slack) {
    double value = verify_total_value(a->sum);
    return fabs(value - b) <= TOLERANCE * fmax(fabs(value), fabs(b)) + a->slack + slack;
}

static void claim_volume(const hearing *own) {
    const verify_surface *model = own->model;
    int scale = own->pieces->scale;
    volume tetrahedra = {{0}, 0}, solid = {{0}, 0};
    double center[3], area = 0;
    for (int k = 0; k < 3; k++)
        center[k] = model->lower[k] / 2 + model->upper[k] / 2;
    for (size_t t = 0; t < own->mesh->count; t++)
        add_tetrahedron(&tetrahedra, own, t);
    for (size_t f = 0; f < model->face_count; f++) {
        const double *t[4] = {center};
        verify_corners(model, f, t + 1);
        add_volume(&solid, t, scale);
        area += verify_area(model, f, scale);
    }
    double expected = verify_total_value(solid.sum);
    double slack = solid.slack + area * ldexp(verify_rounding(model), scale);
    verify_claim(own->verdict, same_volume(&tetrahedra, expected, slack),
                 "the tetrahedra have the volume of the model (%.17g and %.17g)",
                 ldexp(verify_total_value(tetrahedra.sum), -3 * scale),
                 ldexp(expected, -3 * scale));
}

/* ---- pieces ---- */

static uint32_t find_root(uint32_t *parent, uint32_t t) {
    while (parent[t] != t) {
        parent[t] = parent[parent[t]];
        t = parent[t];
    }
    return t;
}

static void join_mates(const hearing *own, uint32_t *parent) {
    const uint32_t *mate = own->pieces->facets->mate;
    for (uint32_t t = 0; t < own->mesh->count; t++)
        parent[t] = t;
    for (uint32_t f = 0; f < 4 * own->mesh->count; f++) {
        if (mate[f] == VERIFY_NONE || own->mesh->labels[mate[f] / 4] != own->mesh->labels[f / 4])
            continue;
        uint32_t a = find_root(parent, f / 4), b = find_root(parent, mate[f] / 4);
        parent[a > b ? a : b] = a > b ? b : a;
    }
}

static starg_status claim_connected(const hearing *own) {
    starg_status status = STARG_OK;
    static const char claim[] = "each piece is connected through faces";
    uint32_t *parent = NULL, *first = NULL, bad = VERIFY_NONE;
    size_t parts = 0;
    STARG_NEW(own->context, STAGE, parent, own->mesh->count);
    STARG_NEW(own->context, STAGE, first, own->pieces->piece_count);
    for (size_t p = 0; p < own->pieces->piece_count; p++)
        first[p] = VERIFY_NONE;
    join_mates(own, parent);
    for (uint32_t t = 0; t < own->mesh->count; t++) {
        int32_t label = own->mesh->labels[t];
        if (parent[t] != t)
            continue;
        if (first[label] == VERIFY_NONE)
            first[label] = t;
        else if (parts++ == 0)
            bad = t;
    }
    if (parts == 0)
        verify_claim(own->verdict, true, "%s", claim);
    else
        verify_claim(own->verdict, false,
                     "%s: piece %d falls apart, tetrahedra %u and %u are not connected "
                     "(%zu parts too many in all)",
                     claim, own->mesh->labels[bad], first[own->mesh->labels[bad]], bad, parts);
done:
    starg_release(own->context, parent);
    starg_release(own->context, first);
    return status;
}

static void claim_counts(const hearing *own) {
    const starg_pieces_report *report = own->report;
    size_t bad = 0, first = 0;
    for (size_t p = report->piece_count; p-- > 0;)
        if (report->pieces[p].tetrahedra != own->pieces->sizes[p]) {
            bad++;
            first = p;
        }
    if (bad == 0)
        verify_claim(own->verdict, true, "each of %zu pieces has as many tetrahedra as claimed",
                     report->piece_count);
    else
        verify_claim(own->verdict, false,
                     "each of %zu pieces has as many tetrahedra as claimed: %zu have not, first "
                     "piece %zu, claimed %zu, found %zu",
                     report->piece_count, bad, first, report->pieces[first].tetrahedra,
                     own->pieces->sizes[first]);
}

static starg_status claim_volumes(const hearing *own) {
    starg_status status = STARG_OK;
    const starg_pieces_report *report = own->report;
    volume *volumes = NULL;
    int scale = own->pieces->scale;
    size_t bad = 0, first = 0;
    STARG_NEW_ZERO(own->context, STAGE, volumes, report->piece_count);
    for (size_t t = 0; t < own->mesh->count; t++)
        add_tetrahedron(&volumes[own->mesh->labels[t]], own, t);
    for (size_t p = report->piece_count; p-- > 0;)
        if (!same_volume(&volumes[p], ldexp(report->pieces[p].volume, 3 * scale), 0)) {
            bad++;
            first = p;
        }
    if (bad == 0)
        verify_claim(own->verdict, true, "each piece has the volume that is claimed");
    else
        verify_claim(own->verdict, false,
                     "each piece has the volume that is claimed: %zu have not, first piece %zu, "
                     "claimed %.17g, found %.17g",
                     bad, first, report->pieces[first].volume,
                     ldexp(verify_total_value(volumes[first].sum), -3 * scale));
done:
    starg_release(own->context, volumes);
    return status;
}

static starg_status claim_contacts(const hearing *own) {
    starg_status status = STARG_OK;
    verify_contacts contacts;
    STARG_TRY(verify_compare_contacts(own->pieces, own->report, &contacts));
    if (contacts.wrong == 0)
        verify_claim(own->verdict, true, "the %zu contacts of pieces and their areas are right",
                     own->report->contact_count);
    else
        verify_claim(own->verdict, false,
                     "the %zu contacts of pieces and their areas are right: %zu are wrong, twice "
                     "or missing, first %u-%u, claimed %.17g, found %.17g",
                     own->report->contact_count, contacts.wrong, contacts.first, contacts.second,
                     contacts.listed, contacts.found);
done:
    return status;
}

/* ---- star-shapedness ---- */

static void tell_failed_proof(const hearing *own, const char *claim, size_t bad, size_t first) {
    const verify_certificate *certificate = &own->certificates[first];
    if (certificate->proof == VERIFY_BEHIND)
        verify_claim(own->verdict, false,
                     "%s: %zu are not, first piece %zu, whose guard is not strictly on the inner "
                     "side of %s",
                     claim, bad, first,
                     facet_words(own, own->pieces->wall_facets[certificate->wall]).text);
    else
        verify_claim(own->verdict, false,
                     "%s: %zu are not, first piece %zu, whose boundary winds %d times around its "
                     "guard",
                     claim, bad, first, certificate->winding);
}

static void claim_star(const hearing *own) {
    static const char claim[] = "pieces called star-shaped are so about their guards";
    const starg_pieces_report *report = own->report;
    size_t bad = 0, first = 0, called = 0, proven = 0;
    for (size_t p = report->piece_count; p-- > 0;) {
        bool good = own->certificates[p].proof == VERIFY_PROVEN;
        called += report->pieces[p].star;
        proven += good;
        if (report->pieces[p].star && !good) {
            bad++;
            first = p;
        }
    }
    if (bad > 0)
        tell_failed_proof(own, claim, bad, first);
    else
        verify_claim(own->verdict, true, "%s (%zu of %zu, exactly proven)", claim, called,
                     report->piece_count);
    verify_claim(own->verdict, report->strictly_star == proven && called == proven,
                 "%zu pieces are strictly star-shaped (called so: %zu, found: %zu)",
                 report->strictly_star, called, proven);
    if (report->mode == STARG_DECOMPOSE_STRICT)
        verify_claim(own->verdict, proven == report->piece_count,
                     "in strict mode all %zu pieces are star-shaped (found: %zu)",
                     report->piece_count, proven);
}

/* All vertices but those drawn at random leave no doubt; a share that was drawn is allowed five
 * times its standard error. */
static bool agrees(const verify_seen *seen, double claimed) {
    double open = (double)(seen->pairs - seen->proven), all = (double)seen->pairs;
    if (seen->looked == seen->pairs - seen->proven)
        return fabs(claimed * all - (double)(seen->proven + seen->seen)) <= TOLERANCE * all;
    double share = (claimed * all - (double)seen->proven) / open;
    double drawn = (double)seen->looked, found = (double)seen->seen / drawn;
    if (!(share >= -TOLERANCE && share <= 1 + TOLERANCE))
        return false;
    return fabs(found - share) <= 5 * sqrt(fmax(share * (1 - share), 0) / drawn) + 5 / drawn;
}

static starg_status claim_seen(const hearing *own) {
    starg_status status = STARG_OK;
    verify_seen seen;
    STARG_TRY(verify_find_seen(own->pieces, own->report, own->certificates, &seen));
    double open = (double)(seen.pairs - seen.proven), share = 0;
    if (seen.looked > 0)
        share = (double)seen.seen / (double)seen.looked;
    verify_claim(own->verdict, agrees(&seen, own->report->visible_vertices),
                 "guards see a fraction of %.17g of their pieces' vertices (found: %.17g; %zu of "
                 "%zu lines tested)",
                 own->report->visible_vertices,
                 ((double)seen.proven + share * open) / (double)seen.pairs, seen.looked,
                 seen.pairs);
done:
    return status;
}

static starg_status claim_guards(hearing *own) {
    starg_status status = STARG_OK;
    STARG_NEW(own->context, STAGE, own->certificates, own->report->piece_count);
    STARG_TRY(verify_certify(own->pieces, own->report, own->certificates));
    claim_star(own);
    STARG_TRY(claim_seen(own));
done:
    starg_release(own->context, own->certificates);
    return status;
}

/* ---- all of it ---- */

static starg_status hear(hearing *own) {
    starg_status status = STARG_OK;
    bool labelled = own->pieces->labels.good;
    STARG_TRY(claim_positive(own));
    claim_conforming(own);
    claim_labels(own);
    STARG_TRY(claim_boundary(own));
    if (own->report == NULL || !own->report->approximated)
        claim_volume(own);
    if (labelled)
        STARG_TRY(claim_connected(own));
    if (own->report == NULL)
        goto done;
    claim_size(own);
    if (!labelled)
        goto done; /* nothing can be said about pieces */
    claim_counts(own);
    STARG_TRY(claim_volumes(own));
    STARG_TRY(claim_contacts(own));
    STARG_TRY(claim_guards(own));
done:
    return status;
}

static starg_status verify_against(starg_context *context, const verify_surface *model,
                                   const starg_pieces_mesh *mesh, const starg_pieces_report *report,
                                   starg_verdict **out) {
    starg_status status = STARG_OK;
    hearing own = {.context = context, .mesh = mesh, .report = report, .model = model};
    STARG_TRY(check_arrays(context, mesh));
    STARG_TRY(verify_pieces_create(context, mesh, report, &own.pieces));
    STARG_TRY(verify_verdict_create(context, &own.verdict));
    STARG_TRY(hear(&own));
    *out = own.verdict;
    own.verdict = NULL;
done:
    verify_pieces_free(own.pieces);
    starg_verdict_free(context, own.verdict);
    return status;
}

/* The model as it is: where the boundary is only near it, it need not be closed. */
static starg_status wrap_model(starg_context *context, const starg_mesh *mesh,
                               verify_surface **out) {
    starg_status status = STARG_OK;
    uint32_t *faces = NULL;
    size_t count = starg_mesh_face_count(mesh);
    if (count == 0)
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the model has no faces");
    STARG_NEW(context, STAGE, faces, 3 * count);
    memcpy(faces, starg_mesh_faces(mesh), 3 * count * sizeof *faces);
    STARG_TRY(verify_surface_wrap(context, starg_mesh_vertices(mesh), starg_mesh_vertex_count(mesh),
                                  faces, count, out));
done:
    return status;
}

starg_status starg_verify_pieces(starg_context *context, const starg_mesh *model,
                                 const starg_pieces_mesh *pieces, const starg_pieces_report *report,
                                 starg_verdict **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    *out = NULL;
    if (report != NULL && report->approximated)
        STARG_TRY(wrap_model(context, model, &surface));
    else
        STARG_TRY(verify_surface_create(context, model, &surface));
    STARG_TRY(verify_against(context, surface, pieces, report, out));
done:
    verify_surface_free(surface);
    return status;
}

/* The boundary of the model's tetrahedra. */
static starg_status wrap_boundary(starg_context *context, const starg_tetmesh *model,
                                  verify_surface **out) {
    starg_status status = STARG_OK;
    verify_facets *facets = NULL;
    uint32_t *outer = NULL, *faces = NULL;
    size_t count;
    STARG_TRY(verify_facets_create(context, starg_tetmesh_tetrahedra(model),
                                   starg_tetmesh_count(model), &facets));
    STARG_TRY(verify_facets_outer(facets, &outer, &faces, &count));
    status = verify_surface_wrap(context, starg_tetmesh_vertices(model),
                                 starg_tetmesh_vertex_count(model), faces, count, out);
    faces = NULL;
done:
    starg_release(context, outer);
    starg_release(context, faces);
    verify_facets_free(facets);
    return status;
}

starg_status starg_verify_pieces_of_tetmesh(starg_context *context, const starg_tetmesh *model,
                                            const starg_pieces_mesh *pieces,
                                            const starg_pieces_report *report,
                                            starg_verdict **out) {
    starg_status status = STARG_OK;
    verify_surface *surface = NULL;
    *out = NULL;
    STARG_TRY(wrap_boundary(context, model, &surface));
    STARG_TRY(verify_against(context, surface, pieces, report, out));
done:
    verify_surface_free(surface);
    return status;
}
