/* SPDX-License-Identifier: Apache-2.0 */
/* The report's numeric claims: tetrahedra, volumes, contacts and radii of the pieces, and flatness
 * of tetrahedra. Cost: O(n). */
#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";

static void claim_size(const verify_context *own) {
    verify_claim(own->verdict, own->report->tetrahedra == own->mesh->count,
                 "there are %zu tetrahedra (the file holds %zu)", own->report->tetrahedra,
                 own->mesh->count);
}

/* Numbers that are not told are no claim; a report read from a file tells them. */
static void claim_model(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    const verify_surface *model = own->model;
    if (report->model_vertices == 0) {
        verify_leave(own->verdict, "of which model the pieces are: the report does not tell it");
        return;
    }
    bool solid = own->model_tetrahedra > 0;
    size_t told = solid ? report->model_tetrahedra : report->model_faces;
    size_t found = solid ? own->model_tetrahedra : model->model_faces;
    verify_claim(own->verdict, report->model_vertices == model->model_vertices && told == found,
                 "the model has %zu vertices and %zu %s (the mesh: %zu and %zu)",
                 report->model_vertices, told, solid ? "tetrahedra" : "faces",
                 model->model_vertices, found);
}

static void claim_counts(const verify_context *own) {
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

static starg_status claim_volumes(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    SCOPED verify_volume *volumes = NULL;
    int scale = own->pieces->scale;
    double lost =
        ldexp(0x1p-1022, 3 * scale); /* largest volume that underflows in the model's unit */
    size_t bad = 0, first = 0;
    NEW_ZERO(own->context, STAGE, volumes, report->piece_count);
    for (size_t t = 0; t < own->mesh->count; t++)
        verify_add_tetrahedron(&volumes[own->mesh->labels[t]], own->mesh, t, scale);
    for (size_t p = report->piece_count; p-- > 0;)
        if (!verify_same_volume(&volumes[p], ldexp(report->pieces[p].volume, 3 * scale), lost)) {
            bad++;
            first = p;
        }
    if (bad == 0)
        verify_claim(own->verdict, true, "each piece has the volume that is claimed");
    else
        verify_claim(own->verdict, false,
                     "each piece has the volume that is claimed: %zu have not, first piece %zu, "
                     "claimed %.9g, found %.9g",
                     bad, first, report->pieces[first].volume,
                     ldexp(verify_volume_value(&volumes[first]), -3 * scale));
    return STARG_OK;
}

static starg_status claim_contacts(const verify_context *own) {
    verify_contacts contacts;
    TRY(verify_compare_contacts(own->pieces, own->report, &contacts));
    if (contacts.wrong == 0)
        verify_claim(own->verdict, true, "the %zu contacts of pieces and their areas are right",
                     own->report->contact_count);
    else
        verify_claim(own->verdict, false,
                     "the %zu contacts of pieces and their areas are right: %zu are wrong, twice "
                     "or missing, first %u-%u, claimed %.9g, found %.9g",
                     own->report->contact_count, contacts.wrong, contacts.first, contacts.second,
                     contacts.listed, contacts.found);
    return STARG_OK;
}

/* ---- radius ---- */

/* Bounds for the distance from a piece's guard to the nearest plane of a wall, given the rounding
 * of normals. Thin walls leave the widest interval. */
static void bound_radius(const verify_context *own, size_t piece, double *least, double *most) {
    const verify_pieces *pieces = own->pieces;
    const double *guard = own->report->pieces[piece].guard;
    *least = *most = INFINITY;
    for (size_t wall = pieces->wall_start[piece]; wall < pieces->wall_start[piece + 1]; wall++) {
        const double *t[3];
        double n[3], length = 0, along = 0, away = 0, extent = 0;
        verify_corners(pieces->walls, wall, t);
        verify_normal(pieces->walls, wall, pieces->scale, n);
        for (int k = 0; k < 3; k++) {
            double d = ldexp(t[0][k] - guard[k], pieces->scale);
            along += n[k] * d;
            away = hypot(away, d);
            length = hypot(length, n[k]);
            extent +=
                ldexp(fmax(fmax(t[0][k], t[1][k]), t[2][k]) - fmin(fmin(t[0][k], t[1][k]), t[2][k]),
                      pieces->scale);
        }
        if (!(length > 0))
            continue;
        double slack = 0x1p-48 * away * (1 + extent * extent / length);
        *least = fmin(*least, along / length - slack);
        *most = fmin(*most, along / length + slack);
    }
}

static void claim_radius(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    size_t bad = 0, first = 0, told = 0;
    double found = 0, slack = 0x1p-46 * ldexp(1, -own->pieces->scale);
    for (size_t p = report->piece_count; p-- > 0;) {
        double least, most, claimed = report->pieces[p].radius;
        if (isnan(claimed))
            continue;
        told++;
        bound_radius(own, p, &least, &most);
        least = ldexp(least, -own->pieces->scale);
        most = ldexp(most, -own->pieces->scale);
        if (claimed >= least - slack && claimed <= most + slack)
            continue;
        bad++;
        first = p;
        found = least / 2 + most / 2;
    }
    if (told < report->piece_count)
        verify_leave(own->verdict, "the radius of %zu pieces: the report does not tell it",
                     report->piece_count - told);
    if (bad > 0)
        verify_claim(own->verdict, false,
                     "guards are as far from the planes of their pieces' faces as claimed: %zu are "
                     "not, first piece %zu, claimed %.9g, found %.9g",
                     bad, first, report->pieces[first].radius, found);
    else if (told > 0)
        verify_claim(own->verdict, true,
                     "guards are as far from the planes of their pieces' faces as claimed");
}

/* ---- margins ---- */

/* The diagonal of the bounding box of a piece's walls. */
static double find_diagonal(const verify_context *own, size_t piece) {
    const verify_pieces *pieces = own->pieces;
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t wall = pieces->wall_start[piece]; wall < pieces->wall_start[piece + 1]; wall++) {
        const double *t[3];
        verify_corners(pieces->walls, wall, t);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                lower[k] = fmin(lower[k], t[i][k]);
                upper[k] = fmax(upper[k], t[i][k]);
            }
    }
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

/* Radii are checked by themselves. */
static void claim_margins(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    size_t bad = 0, first = 0, told = 0;
    for (size_t p = report->piece_count; p-- > 0;) {
        double claimed = report->pieces[p].margin;
        double found = report->pieces[p].radius / find_diagonal(own, p);
        bool known = !isnan(claimed) && !isnan(report->pieces[p].radius);
        told += known;
        if (!known || fabs(claimed - found) <= 1e-9 * fabs(found))
            continue;
        bad++;
        first = p;
    }
    if (told < report->piece_count)
        verify_leave(own->verdict,
                     "the margin of %zu pieces: the report does not tell it, or not the radius",
                     report->piece_count - told);
    if (told > 0)
        verify_claim(own->verdict, bad == 0,
                     bad == 0 ? "margins are radii by the diagonals of the pieces"
                              : "margins are radii by the diagonals of the pieces: %zu are not, "
                                "first piece %zu",
                     bad, first);
}

/* ---- flatness ---- */

/* Least height over longest edge of a tetrahedron, which is independent of scale. */
static double flatness_of(const verify_context *own, size_t tetrahedron) {
    const uint32_t *corners = own->mesh->tetrahedra + 4 * tetrahedron;
    const double *t[4];
    double longest = 0, largest = 0;
    verify_volume volume = {0};
    for (int i = 0; i < 4; i++)
        t[i] = verify_point(own->mesh, corners[i]);
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
            longest = fmax(longest,
                           hypot(hypot(t[i][0] - t[j][0], t[i][1] - t[j][1]), t[i][2] - t[j][2]));
    if (!(longest > 0))
        return 0;
    int scale = -ilogb(longest); /* unit near the longest edge */
    for (int i = 0; i < 4; i++)
        largest = fmax(largest, verify_triangle_area(t[i], t[(i + 1) % 4], t[(i + 2) % 4], scale));
    verify_add_volume(&volume, t, scale);
    return largest > 0 ? 3 * fabs(verify_volume_value(&volume)) / largest / ldexp(longest, scale)
                       : 0;
}

static void claim_flattest(const verify_context *own) {
    double claimed = own->report->flattest, found = 1;
    if (claimed > 0) {
        for (size_t t = 0; t < own->mesh->count; t++)
            found = fmin(found, flatness_of(own, t));
        verify_claim(own->verdict, fabs(claimed - found) <= 1e-9 * claimed + 1e-12,
                     "the flattest tetrahedron has a height of %.9g of its longest edge (found: "
                     "%.9g)",
                     claimed, found);
    } else {
        verify_leave(own->verdict, "the flattest tetrahedron: the report does not tell it");
    }
    verify_leave(own->verdict, "how flat tetrahedra were to begin with");
}

starg_status verify_claim_numbers(const verify_context *own) {
    claim_model(own);
    claim_size(own);
    claim_flattest(own);
    if (!own->pieces->labels.good)
        return STARG_OK;
    claim_counts(own);
    TRY(claim_volumes(own));
    TRY(claim_contacts(own));
    claim_radius(own);
    claim_margins(own);
    return STARG_OK;
}
