/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra whose surface comes as near to B as they allow.
 *
 * Problem: the surface of B in A's faces may meet itself, or fold so that tetrahedra with all of it
 * in place cannot all be positive. Find places for all vertices such that every tetrahedron is
 * positive and the surface differs from B's as little as possible.
 *
 * Stages:
 *   1. unfold (unfold.c), with springs on the surface instead of fixed vertices. Between its
 * rounds, a vertex that is away from its place is drawn to the nearest point of B's surface
 * instead: so it gives way where the map of the surfaces folds, and slides along B rather than off
 * it;
 *   2. with all tetrahedra positive, and kept so, the springs are tightened several times;
 *   3. vertices go to where they are drawn, exactly, unless a tetrahedron would become inverted, or
 *      thin and thinner than it was. What is left is off B.
 *
 * Invariant from stage 2 on: every tetrahedron is positive, exactly. Cost: that of unfold, and
 * typically O(log n) a vertex of the surface in each round. */
#include "morph/solid_map.h"

#include "geometry/bvh.h"
#include "geometry/vec3.h"
#include "mesh/mesh.h"

static const char STAGE[] = "solid map";

enum { UNFOLD_STEPS = 6000, ROUNDS = 6, ROUND_STEPS = 100, SWEEPS = 2 };
/* In diagonals of B: the displacement of all springs that costs a third of what all tetrahedra do;
 * how far from its place a vertex is drawn elsewhere; and from where on it counts as off B. */
static const double LENGTH = 0.01, ASTRAY = 1e-4, OFF = 1e-9;
static const double TIGHTER = 10; /* from round to round */
/* Six volumes over the cube of the longest edge, below which a tetrahedron is thin. */
static const double THIN = 1e-5;

typedef struct approaching {
    deform_mesh *c;
    unfold_problem p;
    double *places;  /* of the surface in B, fixed x 3 */
    double *targets; /* where its vertices are drawn */
    uint32_t *faces; /* of the surface, by vertices of the tetrahedra */
    bvh *surface;    /* of B */
    double diagonal;
    size_t *first; /* by vertex of the surface: the first of its tetrahedra in `around` */
    uint32_t *around;
} approaching;

static void free_all(approaching *a) {
    bvh_free(a->surface);
    RELEASE(a->places, a->targets, a->faces, a->first, a->around);
}

static double *now_of(const approaching *a, size_t v) {
    return a->p.now + 3 * v;
}

/* ---- preparation ---- */

static double diagonal_of(const double *places, size_t count) {
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * count; i++) {
        lower[i % 3] = fmin(lower[i % 3], places[i]);
        upper[i % 3] = fmax(upper[i % 3], places[i]);
    }
    return vec3_distance(lower, upper);
}

/* The mesh's faces, by vertices of the tetrahedra. */
static starg_status list_faces(approaching *a, const starg_mesh *mesh) {
    starg_context *context = a->c->context;
    SCOPED uint32_t *own = NULL;
    NEW(context, STAGE, own, mesh->vertex_count);
    NEW(context, STAGE, a->faces, 3 * mesh->face_count);
    for (uint32_t v = 0; v < a->c->fixed; v++)
        own[a->c->surface[v]] = v;
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        a->faces[i] = own[mesh->faces[i]];
    return bvh_create(context, a->places, a->faces, mesh->face_count, &a->surface);
}

static starg_status list_around(approaching *a) {
    const unfold_problem *p = &a->p;
    size_t count = a->c->fixed;
    NEW_ZERO(p->context, STAGE, a->first, count + 2);
    for (size_t i = 0; i < 4 * p->count; i++)
        if (p->tetrahedra[i] < count)
            a->first[p->tetrahedra[i] + 2]++;
    for (size_t v = 0; v < count; v++)
        a->first[v + 2] += a->first[v + 1];
    NEW(p->context, STAGE, a->around, a->first[count + 1]);
    for (size_t i = 0; i < 4 * p->count; i++)
        if (p->tetrahedra[i] < count)
            a->around[a->first[p->tetrahedra[i] + 1]++] = (uint32_t)(i / 4);
    return STARG_OK;
}

/* Vertices away from their places are drawn to the nearest point of the surface. */
static void choose_targets(void *user) {
    approaching *a = user;
    for (size_t v = 0; v < a->c->fixed; v++) {
        const double *place = a->places + 3 * v;
        if (vec3_distance(now_of(a, v), place) > ASTRAY * a->diagonal)
            bvh_nearest(a->surface, now_of(a, v), a->targets + 3 * v);
        else
            vec3_copy(place, a->targets + 3 * v);
    }
}

static starg_status begin(approaching *a, const starg_mesh *mesh, double strength) {
    deform_mesh *c = a->c;
    size_t size = 3 * c->fixed;
    NEW(c->context, STAGE, a->places, size);
    NEW(c->context, STAGE, a->targets, size);
    memcpy(a->places, c->now.data, size * sizeof *a->places);
    memcpy(a->targets, c->now.data, size * sizeof *a->targets);
    a->diagonal = diagonal_of(a->places, c->fixed);
    a->p = (unfold_problem){.context = c->context,
                            .vertex_count = c->rest.count / 3,
                            .count = c->tetrahedra.count / 4,
                            .tetrahedra = c->tetrahedra.data,
                            .rest = c->rest.data,
                            .now = c->now.data,
                            .springs = {.count = c->fixed,
                                        .targets = a->targets,
                                        .strength = strength,
                                        .length = LENGTH * a->diagonal,
                                        .move = choose_targets,
                                        .user = a}};
    TRY(list_faces(a, mesh));
    return list_around(a);
}

/* ---- the end ---- */

/* Six volumes over the cube of the longest edge. */
static double thickness(const approaching *a, size_t tetrahedron) {
    const uint32_t *corners = a->p.tetrahedra + 4 * tetrahedron;
    double edges[3][3], longest = 0;
    for (size_t i = 0; i < 4; i++)
        for (size_t j = 0; j < i; j++)
            longest = fmax(longest, vec3_distance(now_of(a, corners[i]), now_of(a, corners[j])));
    for (size_t k = 0; k < 3; k++)
        vec3_subtract(now_of(a, corners[k + 1]), now_of(a, corners[0]), edges[k]);
    return vec3_triple(edges[0], edges[1], edges[2]) / (longest * longest * longest);
}

/* The thinnest tetrahedron at a vertex; below 0 if one is not positive. */
static double thinnest_around(const approaching *a, size_t v) {
    double least = INFINITY;
    for (size_t i = a->first[v]; i < a->first[v + 1]; i++) {
        if (!unfold_is_positive(&a->p, a->around[i]))
            return -1;
        least = fmin(least, thickness(a, a->around[i]));
    }
    return least;
}

/* Vertices that may go to their targets do. */
static void go_there(approaching *a) {
    for (size_t v = 0; v < a->c->fixed; v++) {
        double former[3], before = thinnest_around(a, v);
        vec3_copy(now_of(a, v), former);
        vec3_copy(a->targets + 3 * v, now_of(a, v));
        if (!(thinnest_around(a, v) >= fmin(before, THIN)))
            vec3_copy(former, now_of(a, v));
    }
}

static void measure(const approaching *a, approach_result *out) {
    for (size_t v = 0; v < a->c->fixed; v++) {
        double off = bvh_distance(a->surface, now_of(a, v)) / a->diagonal;
        out->strayed += off > OFF;
        out->farthest = fmax(out->farthest, off);
    }
}

starg_status approach(deform_mesh *c, const starg_mesh *mesh, double strength,
                      approach_result *out) {
    SCOPED_BY(free_all) approaching a = {.c = c};
    *out = (approach_result){0};
    TRY(begin(&a, mesh, strength));
    TRY(unfold(&a.p, UNFOLD_STEPS, &out->inverted));
    if (out->inverted > 0)
        return STARG_OK;
    for (int round = 0; round < ROUNDS; round++) {
        a.p.springs.strength *= TIGHTER;
        TRY(unfold_relax(&a.p, ROUND_STEPS));
        choose_targets(&a);
    }
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        go_there(&a);
    measure(&a, out);
    return STARG_OK;
}
