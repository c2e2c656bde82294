/* SPDX-License-Identifier: Apache-2.0 */
/* The claims of [YL11, section 4] about visibly dependent tetrahedra, by brute force in rationals:
 *
 * a) t is visible if all of its predecessors are visible;
 * b) t can be added to a region without violating its star-property if its predecessors are in it.
 *
 * They are theorems if "visible" refers to every point of the predecessors: then the four vertices
 * of t are visible; for b) the region with t is the solid. In the paper's sense, where "visible"
 * refers to the four vertices, they hold nearly always. */
#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "star/paper/state.h"
#include "tetrahedra.h"

/* ---- a solid made of some of the tetrahedra ---- */

typedef struct world {
    paper_state state;
    paper_domain all;
    paper_guard guard;
    paper_guard looking; /* the same, with `toward` also for vertices that it does not see */
    bool *member;        /* the tetrahedra of the solid */
    uint32_t *faces;     /* its boundary */
    size_t face_count;
    char *known; /* per tetrahedron, is all of it visible: y, n, or 0 (unknown) */
} world;

static void find_boundary(world *w) {
    const starg_tetmesh *mesh = w->state.mesh;
    w->face_count = 0;
    memset(w->known, 0, mesh->count);
    for (size_t f = 0; f < 4 * mesh->count; f++) {
        uint32_t next = mesh->neighbours[f];
        if (!w->member[f / 4] || (next != STARG_TETMESH_NONE && w->member[next]))
            continue;
        for (int k = 0; k < 3; k++)
            w->faces[3 * w->face_count + (size_t)k] =
                mesh->tetrahedra[(f & ~(size_t)3) + (size_t)TETMESH_FACE[f & 3][k]];
        w->face_count++;
    }
}

static const double *point(const world *w, uint32_t vertex) {
    return w->state.mesh->vertices + 3 * (size_t)vertex;
}

/* Are all points of one set on one side of all points of the other, along an axis? */
static bool are_apart(const double *const *a, int a_count, const double *const *b, int b_count) {
    for (int k = 0; k < 3; k++) {
        double low[2] = {a[0][k], b[0][k]}, high[2] = {a[0][k], b[0][k]};
        for (int i = 0; i < a_count; i++) {
            low[0] = fmin(low[0], a[i][k]);
            high[0] = fmax(high[0], a[i][k]);
        }
        for (int i = 0; i < b_count; i++) {
            low[1] = fmin(low[1], b[i][k]);
            high[1] = fmax(high[1], b[i][k]);
        }
        if (high[0] < low[1] || high[1] < low[0])
            return true;
    }
    return false;
}

static void corners_of(const world *w, size_t face, const double *out[3]) {
    for (size_t i = 0; i < 3; i++)
        out[i] = point(w, w->faces[3 * face + i]);
}

static bool sees_vertex(const world *w, uint32_t vertex) {
    const double *segment[2] = {w->guard.position, point(w, vertex)}, *b[3];
    for (size_t f = 0; f < w->face_count; f++) {
        corners_of(w, f, b);
        if (!are_apart(segment, 2, b, 3) &&
            oracle_segment_meets_triangle(segment[0], segment[1], b[0], b[1], b[2]))
            return false;
    }
    return true;
}

static bool sees_vertices(const world *w, uint32_t t) {
    for (size_t k = 0; k < 4; k++)
        if (!sees_vertex(w, w->state.mesh->tetrahedra[4 * (size_t)t + k]))
            return false;
    return true;
}

/* Every point of a tetrahedron: no boundary face has a point in the hull of the guard and one of
 * the tetrahedron's faces, except on that face. */
static bool sees_hulls(const world *w, uint32_t t) {
    const double *p[4], *b[3];
    for (size_t k = 0; k < 4; k++)
        p[k] = point(w, w->state.mesh->tetrahedra[4 * (size_t)t + k]);
    for (int k = 0; k < 4; k++) {
        const int *c = TETMESH_FACE[k];
        const double *hull[4] = {p[c[0]], p[c[1]], p[c[2]], w->guard.position};
        for (size_t f = 0; f < w->face_count; f++) {
            corners_of(w, f, b);
            if (!are_apart(hull, 4, b, 3) &&
                oracle_tetrahedron_meets_triangle(w->guard.position, hull, b))
                return false;
        }
    }
    return true;
}

static bool sees_all_of(const world *w, uint32_t t) {
    if (w->known[t] == 0)
        w->known[t] = sees_hulls(w, t) ? 'y' : 'n';
    return w->known[t] == 'y';
}

/* No face plane contains the guard: hulls have volume, and segments enter a single tetrahedron. */
static bool is_general(const world *w) {
    for (size_t t = 0; t < w->state.mesh->count; t++)
        for (int k = 0; k < 4; k++) {
            const int *c = TETMESH_FACE[k];
            const uint32_t *v = w->state.mesh->tetrahedra + 4 * t;
            if (oracle_orient3d(point(w, v[c[0]]), point(w, v[c[1]]), point(w, v[c[2]]),
                                w->guard.position) == 0)
                return false;
        }
    return true;
}

static void world_create(starg_context *context, starg_tetmesh *mesh, world *w) {
    *w = (world){.state = {.context = context, .mesh = mesh, .diagonal = 1}};
    test_ok(context, tet_rings_create(context, mesh, &w->state.rings));
    test_ok(context, tet_sight_create(context, mesh, &w->state.sight));
    w->all = (paper_domain){.tetrahedra = malloc(4 * mesh->count),
                            .vertices = malloc(4 * mesh->vertex_count),
                            .count = mesh->count};
    w->member = malloc(mesh->count);
    w->faces = malloc(48 * mesh->count);
    w->known = malloc(mesh->count);
    assert_true(w->all.tetrahedra && w->all.vertices && w->member && w->faces && w->known);
    for (uint32_t t = 0; t < mesh->count; t++)
        w->all.tetrahedra[t] = t;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (w->state.rings.first[v] < w->state.rings.first[v + 1])
            w->all.vertices[w->all.vertex_count++] = v;
}

/* A guard near the centroid of a tetrahedron. */
static void place_guard(world *w, starg_rng *rng) {
    double p[3], weights[4], sum = 0;
    uint32_t t = (uint32_t)starg_rng_below(rng, w->state.mesh->count);
    for (int k = 0; k < 4; k++) {
        weights[k] = 0.2 + starg_rng_unit(rng);
        sum += weights[k];
    }
    for (int c = 0; c < 3; c++) {
        p[c] = 0;
        for (int k = 0; k < 4; k++)
            p[c] += weights[k] / sum * tetmesh_corner(w->state.mesh, t, k)[c];
    }
    test_ok(w->state.context, views_create(&w->state, &w->all, p, 1, &w->guard));
    w->looking = w->guard;
    test_ok(w->state.context, view_create(&w->state, &w->looking));
    for (size_t i = 0; i < w->all.vertex_count; i++)
        w->looking.toward[w->all.vertices[i]] = dependency_toward(&w->state, w->all.vertices[i], p);
}

static void drop_guard(world *w) {
    view_free(&w->guard);
    view_free(&w->looking);
}

static void world_free(world *w) {
    tet_rings_free(&w->state.rings);
    tet_sight_free(&w->state.sight);
    starg_tetmesh_free(w->state.mesh);
    free(w->all.tetrahedra);
    free(w->all.vertices);
    free(w->member);
    free(w->faces);
    free(w->known);
}

/* ---- stored values against the paper's definitions ---- */

/* The predecessor of a vertex is the tetrahedron that the segment to the guard passes through, at
 * the vertex or behind the face opposite it. */
static void check_predecessors(const world *w, uint32_t t) {
    const uint32_t *v = w->state.mesh->tetrahedra + 4 * (size_t)t;
    for (int k = 0; k < 4; k++) {
        uint32_t p = dependency_predecessor(&w->state, &w->guard, t, k);
        if (p == PAPER_NONE)
            continue; /* the segment ends in t */
        assert_int_not_equal(p, t);
        bool met = false, has_vertex = false;
        const uint32_t *u = w->state.mesh->tetrahedra + 4 * (size_t)p;
        for (int f = 0; f < 4; f++) {
            const int *c = TETMESH_FACE[f];
            has_vertex = has_vertex || u[f] == v[k];
            met = met || oracle_segment_meets_triangle(w->guard.position, point(w, v[k]),
                                                       point(w, u[c[0]]), point(w, u[c[1]]),
                                                       point(w, u[c[2]]));
        }
        assert_true(met || p == w->guard.home);
        if (!has_vertex) {
            assert_int_equal(w->guard.toward[v[k]], t);
            assert_int_equal(w->state.mesh->neighbours[4 * (size_t)t + (size_t)k], p);
        }
    }
}

/* ---- claims ---- */

typedef struct record {
    size_t theorem;      /* cases in which every point of the predecessors is visible */
    size_t cases, wrong; /* ... in which their vertices are, and t is not */
} record;

/* Does the segment to the guard leave the mesh at a vertex or behind the face opposite it? */
static bool leaves(const world *w, uint32_t t, int k) {
    const int *c = TETMESH_FACE[k];
    const uint32_t *v = w->state.mesh->tetrahedra + 4 * (size_t)t;
    uint32_t toward = w->looking.toward[v[k]];
    if (toward != t)
        return toward == PAPER_NONE;
    return w->state.mesh->neighbours[4 * (size_t)t + (size_t)k] == STARG_TETMESH_NONE &&
           oracle_orient3d(point(w, v[c[0]]), point(w, v[c[1]]), point(w, v[c[2]]),
                           w->guard.position) < 0;
}

/* Tries one tetrahedron in the solid formed by the members. */
static void try_claim(const world *w, uint32_t t, record *tally) {
    bool vertices = true, whole = true;
    for (int k = 0; k < 4; k++) {
        uint32_t p = dependency_predecessor(&w->state, &w->looking, t, k);
        vertices = vertices && !leaves(w, t, k);
        if (!vertices || p == PAPER_NONE)
            continue;
        vertices = w->member[p] && sees_vertices(w, p);
        whole = whole && vertices && sees_all_of(w, p);
    }
    if (!vertices)
        return;
    bool seen = sees_vertices(w, t);
    tally->cases++;
    tally->wrong += !seen;
    if (!whole)
        return;
    tally->theorem++;
    assert_true(seen);
}

static bool all_toward(const world *w, uint32_t t) {
    return dependency_seen(&w->state, &w->guard, t) == 4;
}

static void run_a(world *w, record *tally) {
    memset(w->member, true, w->state.mesh->count);
    find_boundary(w);
    for (uint32_t v = 0; v < w->state.mesh->vertex_count; v++)
        if (w->state.rings.first[v] < w->state.rings.first[v + 1])
            assert_int_equal(w->guard.toward[v] != PAPER_NONE, sees_vertex(w, v));
    for (uint32_t t = 0; t < w->state.mesh->count; t++) {
        if (all_toward(w, t))
            check_predecessors(w, t);
        try_claim(w, t, tally);
    }
}

static bool is_ready(const world *w, uint32_t t) {
    if (w->member[t] || !all_toward(w, t))
        return false;
    for (int k = 0; k < 4; k++) {
        uint32_t p = dependency_predecessor(&w->state, &w->guard, t, k);
        if (p != PAPER_NONE && !w->member[p])
            return false;
    }
    return true;
}

/* Grows a region in random order; each step is a case. */
static void run_b(world *w, starg_rng *rng, record *tally) {
    memset(w->member, false, w->state.mesh->count);
    uint32_t next = w->guard.home;
    for (int size = 0; next != PAPER_NONE && size < 24; size++) {
        w->member[next] = true;
        find_boundary(w);
        try_claim(w, next, tally);
        next = PAPER_NONE;
        size_t choices = 0;
        for (uint32_t t = 0; t < w->state.mesh->count; t++)
            if (is_ready(w, t) && starg_rng_below(rng, ++choices) == 0)
                next = t;
    }
}

static void test_claims(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    record a = {0}, b = {0};
    for (uint64_t seed = 0; seed < 6; seed++) {
        starg_rng rng = starg_rng_make(seed, 21, 0);
        world w;
        world_create(context, random_tetmesh(context, seed, 10 + seed, false, 1), &w);
        for (int i = 0; i < 2; i++) {
            place_guard(&w, &rng);
            if (is_general(&w)) {
                run_a(&w, &a);
                run_b(&w, &rng, &b);
            }
            drop_guard(&w);
        }
        world_free(&w);
    }
    print_message("a) %zu cases as a theorem; %zu by vertices, of which %zu fail\n", a.theorem,
                  a.cases, a.wrong);
    print_message("b) %zu cases as a theorem; %zu by vertices, of which %zu fail\n", b.theorem,
                  b.cases, b.wrong);
    assert_true(a.theorem > 100);
    assert_true(b.theorem > 100);
    assert_true(20 * a.wrong < a.cases);
    assert_true(20 * b.wrong < b.cases);
    test_context_free(context);
}

/* ---- guards at vertices, on edges and on faces ---- */

/* The first tetrahedron that contains a guard has no predecessors, wherever the guard is. */
static void test_homes(void **state) {
    (void)state;
    static const double weights[][4] = {
        {1, 0, 0, 0}, {0.5, 0.5, 0, 0}, {0.5, 0.25, 0.25, 0}, {0.25, 0.25, 0.25, 0.25}};
    starg_context *context = test_context(1);
    size_t tried[4] = {0};
    for (uint64_t seed = 0; seed < 24; seed++) {
        starg_rng rng = starg_rng_make(seed, 23, 0);
        world w;
        world_create(context,
                     seed > 0 ? random_tetmesh(context, seed, 30 + seed, true, 1)
                              : sample_tetmesh(context, "torus", 3000),
                     &w);
        for (size_t i = 0; i < 200; i++) {
            double p[3] = {0};
            uint32_t t = (uint32_t)starg_rng_below(&rng, w.state.mesh->count);
            for (int k = 0; k < 4; k++)
                for (int c = 0; c < 3; c++)
                    p[c] += weights[i % 4][k] * tetmesh_corner(w.state.mesh, t, k)[c];
            if (!tet_sight_contains(&w.state.sight, p))
                continue;
            test_ok(context, views_create(&w.state, &w.all, p, 1, &w.guard));
            assert_int_not_equal(w.guard.home, PAPER_NONE);
            assert_int_equal(dependency_seen(&w.state, &w.guard, w.guard.home), 4);
            for (int k = 0; k < 4; k++)
                assert_int_equal(dependency_predecessor(&w.state, &w.guard, w.guard.home, k),
                                 PAPER_NONE);
            tried[i % 4]++;
            view_free(&w.guard);
        }
        world_free(&w);
    }
    for (int i = 0; i < 4; i++)
        assert_true(tried[i] > 20);
    test_context_free(context);
}

/* ---- costs ---- */

/* f(t) = 1 + the sum of f(d) / (edges that enter d) over all edges from t to d. */
static void check_costs(const world *w) {
    size_t n = w->state.mesh->count;
    double *expected = calloc(n, sizeof *expected);
    assert_non_null(expected);
    for (uint32_t d = 0; d < n; d++) {
        uint32_t before[4];
        int edges = 0;
        if (!all_toward(w, d))
            continue;
        expected[d] += 1;
        for (int k = 0; k < 4; k++) {
            uint32_t p = dependency_predecessor(&w->state, &w->guard, d, k);
            if (p != PAPER_NONE)
                before[edges++] = p;
        }
        for (int k = 0; k < edges; k++)
            expected[before[k]] += (double)w->guard.cost[d] / edges;
    }
    for (uint32_t t = 0; t < n; t++)
        if (all_toward(w, t))
            assert_true(expected[t] <= 1.0001 * (double)w->guard.cost[t] &&
                        expected[t] >= 0.9999 * (double)w->guard.cost[t]);
    free(expected);
}

static void test_costs(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 13; seed++) {
        starg_rng rng = starg_rng_make(seed, 22, 0);
        world w;
        world_create(context,
                     seed < 12 ? random_tetmesh(context, seed, 12 + 4 * seed, false, 1)
                               : sample_tetmesh(context, "torus", 3000),
                     &w);
        place_guard(&w, &rng);
        check_costs(&w);
        drop_guard(&w);
        world_free(&w);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_claims), cmocka_unit_test(test_homes),
                                       cmocka_unit_test(test_costs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
