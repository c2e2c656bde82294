/* SPDX-License-Identifier: Apache-2.0 */
/* A boundary that approximates the model: how close is it, and does it bound its tetrahedra once?
 * Points of up to 20,000 faces of either surface (a random sample if there are more) are compared
 * with the other: corners, centroid, and a random point of each. The model need not be closed.
 *
 * Overlap: a point lies in as many tetrahedra as the boundary winds around it (verify/facets.c, if
 * all are positive). That number changes only across the boundary. So no two outer faces may cross,
 * and for each shell it must be one at a point just behind it, in a tetrahedron of that shell.
 * Exact; faces that cross only along edges and corners, none of them strictly on both sides of
 * another, are not detected.
 *
 * Cost: typically O(n log n). */

#include "core/rng.h"
#include "verify/pieces.h"

static const char STAGE[] = "verify";

enum { MOST_FACES = 20000, POINTS = 5, RNG_STAGE = 0x6e656172, CANCEL_STEP = 256 };

/* ---- distance ---- */

/* Corners, centroid, and a random point of a face. */
static void sample_face(const double *const t[3], starg_rng *rng, double points[POINTS][3]) {
    double u = starg_rng_unit(rng), v = starg_rng_unit(rng);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++)
            points[i][k] = t[i][k];
        points[3][k] = t[0][k] / 3 + t[1][k] / 3 + t[2][k] / 3;
        points[4][k] = t[0][k] + u * (t[1][k] - t[0][k]) + v * (t[2][k] - t[0][k]);
    }
}

/* How far are points of `surface` from the tree's surface? */
static starg_status measure_reach(const verify_surface *surface, const verify_tree *tree, int scale,
                                  verify_reach *reach) {
    bool all = surface->face_count <= MOST_FACES;
    size_t count = all ? surface->face_count : MOST_FACES;
    for (size_t i = 0; i < count; i++) {
        starg_rng rng = starg_rng_make(0, RNG_STAGE, i);
        size_t face = all ? i : (size_t)starg_rng_below(&rng, surface->face_count);
        const double *t[3];
        double points[POINTS][3];
        verify_corners(surface, face, t);
        sample_face(t, &rng, points);
        for (int j = 0; j < POINTS; j++, reach->points++) {
            double distance = verify_tree_distance(tree, points[j], scale);
            if (distance > reach->farthest) {
                reach->farthest = distance;
                reach->face = face;
            }
        }
        if (i % CANCEL_STEP == 0)
            TRY(starg_check_cancel(surface->context, STAGE));
    }
    return STARG_OK;
}

/* ---- crossings ---- */

typedef struct crossing {
    const verify_surface *surface;
    size_t face, *count, *pair;
} crossing;

static bool cross_face(void *data, uint32_t other) {
    const crossing *own = data;
    const double *s[3], *t[3];
    if (other <= own->face)
        return true;
    verify_corners(own->surface, own->face, s);
    verify_corners(own->surface, other, t);
    if (verify_cross(s, t) && (*own->count)++ == 0) {
        own->pair[0] = own->face;
        own->pair[1] = other;
    }
    return true;
}

starg_status verify_find_crossings(const verify_surface *surface, const verify_tree *tree,
                                   size_t *count, size_t pair[2]) {
    *count = 0;
    for (size_t f = 0; f < surface->face_count; f++) {
        crossing own = {surface, f, count, pair};
        const double *t[3];
        double lower[3], upper[3];
        verify_corners(surface, f, t);
        for (int k = 0; k < 3; k++) {
            lower[k] = fmin(fmin(t[0][k], t[1][k]), t[2][k]);
            upper[k] = fmax(fmax(t[0][k], t[1][k]), t[2][k]);
        }
        verify_tree_visit(tree, lower, upper, cross_face, &own);
        if (f % CANCEL_STEP == 0)
            TRY(starg_check_cancel(surface->context, STAGE));
    }
    return STARG_OK;
}

/* ---- winding ---- */

/* The centroid of a tetrahedron; false if rounding puts it on a side or beyond. */
static bool center_of(const starg_pieces_mesh *mesh, uint32_t tetrahedron, double center[3]) {
    const uint32_t *corners = mesh->tetrahedra + 4 * (size_t)tetrahedron;
    for (int k = 0; k < 3; k++) {
        center[k] = 0;
        for (int i = 0; i < 4; i++)
            center[k] += verify_point(mesh, corners[i])[k] / 4;
    }
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t side[3];
        verify_facet_corners(mesh->tetrahedra, 4 * tetrahedron + i, side);
        if (verify_side(verify_point(mesh, side[0]), verify_point(mesh, side[1]),
                        verify_point(mesh, side[2]), center) <= 0)
            return false;
    }
    return true;
}

static starg_status wind_shells(const verify_pieces *pieces, const verify_tree *tree,
                                verify_nearness *nearness) {
    const verify_surface *outer = pieces->outer;
    SCOPED uint32_t *parent = NULL;
    SCOPED uint8_t *done_with = NULL;
    TRY(verify_find_shells(outer, &parent));
    NEW_ZERO(pieces->context, STAGE, done_with, outer->face_count);
    for (size_t f = 0; f < outer->face_count; f++) {
        uint32_t shell = verify_root(parent, (uint32_t)f);
        double center[3];
        bool on_surface;
        if (done_with[shell] || !center_of(pieces->mesh, pieces->outer_facets[f] / 4, center))
            continue;
        done_with[shell] = 1;
        nearness->shells++;
        int winding = verify_tree_winding(tree, center, &on_surface);
        if ((on_surface || winding != 1) && nearness->multiple++ == 0)
            nearness->shell = f;
        TRY(starg_check_cancel(pieces->context, STAGE));
    }
    return STARG_OK;
}

starg_status verify_measure_boundary(const verify_pieces *pieces, const verify_surface *model,
                                     verify_nearness *nearness) {
    SCOPED_BY(verify_tree_drop) verify_tree *tree = NULL, *model_tree = NULL;
    *nearness = (verify_nearness){0};
    TRY(verify_tree_create(pieces->outer, &tree));
    TRY(verify_tree_create(model, &model_tree));
    TRY(measure_reach(pieces->outer, model_tree, pieces->scale, &nearness->to));
    TRY(measure_reach(model, tree, pieces->scale, &nearness->from));
    TRY(verify_find_crossings(pieces->outer, tree, &nearness->crossings, nearness->pair));
    return wind_shells(pieces, tree, nearness);
}
