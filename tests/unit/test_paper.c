/* SPDX-License-Identifier: Apache-2.0 */
/* Paper mode: results agree with decomposition_oracle.h; they are the same for any number of
 * threads; smoothing does no harm; odd guards and limits; failing memory. */
#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "decomposition_oracle.h"
#include "exact_oracle.h"
#include "shapes.h"
#include "star/decomposition.h"
#include "star/paper/state.h"
#include "starguard/decompose.h"
#include "tetra/tetmesh.h"
#include "tetrahedra.h"

static starg_decompose_options paper_options(void) {
    starg_decompose_options options;
    starg_decompose_options_default(&options);
    options.mode = STARG_DECOMPOSE_PAPER;
    return options;
}

/* The same tetrahedra, with at most interior vertices moved. */
static void check_mesh(starg_context *context, const starg_tetmesh *before,
                       const starg_tetmesh *after) {
    starg_tetmesh *again = NULL;
    bool *outer = calloc(before->vertex_count + 1, sizeof *outer);
    assert_non_null(outer);
    assert_int_equal(after->count, before->count);
    assert_memory_equal(after->tetrahedra, before->tetrahedra, 16 * before->count);
    assert_memory_equal(after->neighbours, before->neighbours, 16 * before->count);
    for (size_t f = 0; f < 4 * before->count; f++)
        for (size_t k = 0; before->neighbours[f] == STARG_TETMESH_NONE && k < 4; k++)
            if (k != f % 4)
                outer[before->tetrahedra[f / 4 * 4 + k]] = true;
    for (size_t v = 0; v < before->vertex_count; v++)
        if (outer[v])
            assert_memory_equal(after->vertices + 3 * v, before->vertices + 3 * v, 24);
    test_ok(context, starg_tetmesh_create(context, after->vertices, after->vertex_count,
                                          after->tetrahedra, after->count, NULL, &again));
    assert_int_equal(starg_tetmesh_turned(again), 0);
    starg_tetmesh_free(again);
    free(outer);
}

/* Random guards, some outside, some repeated. */
static size_t random_guards(const starg_tetmesh *mesh, uint64_t seed, double *guards) {
    starg_rng rng = starg_rng_make(seed, 31, 0);
    size_t count = starg_rng_below(&rng, 6);
    for (size_t i = 0; i < count; i++) {
        size_t t = starg_rng_below(&rng, mesh->count);
        for (int c = 0; c < 3; c++) {
            guards[3 * i + (size_t)c] = 0;
            for (int k = 0; k < 4; k++)
                guards[3 * i + (size_t)c] += 0.25 * tetmesh_corner(mesh, t, k)[c];
        }
        if (i % 3 == 2)
            memcpy(guards + 3 * i, tetmesh_corner(mesh, t, 0), 3 * sizeof *guards);
        if (i % 4 == 3)
            memcpy(guards + 3 * i, guards, 3 * sizeof *guards);
    }
    return count;
}

static void test_random(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (uint64_t seed = 0; seed < 24; seed++) {
        double guards[3 * 6];
        starg_tetmesh *mesh = random_tetmesh(context, seed, 8 + seed, seed % 3 == 1, 1);
        starg_decompose_options options = paper_options();
        starg_decomposition *d = NULL;
        options.guards = guards;
        options.guard_count = random_guards(mesh, seed, guards);
        test_ok(context, starg_decompose_tetmesh(context, mesh, &options, &d));
        assert_int_equal(d->mode, STARG_DECOMPOSE_PAPER);
        decomposition_oracle_check(d);
        decomposition_oracle_check_sight(d);
        decomposition_oracle_check_connected(d);
        check_mesh(context, mesh, d->mesh);
        starg_decomposition_free(context, d);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

/* Models whose sizes differ by a power of two are cut the same way. */
static void test_scales(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const double scales[] = {1, 0x1p-320, 0x1p-60, 0x1p60, 0x1p320};
    for (uint64_t seed = 0; seed < 4; seed++) {
        starg_decomposition *unit = NULL;
        for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
            double guards[3 * 6];
            starg_tetmesh *mesh = random_tetmesh(context, seed, 40, false, scales[i]);
            starg_decompose_options options = paper_options();
            starg_decomposition *d = NULL;
            options.guards = guards;
            options.guard_count = random_guards(mesh, seed, guards);
            test_ok(context, starg_decompose_tetmesh(context, mesh, &options, &d));
            starg_tetmesh_free(mesh);
            if (i == 0) {
                unit = d;
                continue;
            }
            assert_int_equal(d->piece_count, unit->piece_count);
            assert_int_equal(d->strictly_star, unit->strictly_star);
            assert_memory_equal(d->labels, unit->labels, sizeof *d->labels * d->mesh->count);
            for (size_t k = 0; k < 3 * d->mesh->vertex_count; k++)
                assert_true(d->mesh->vertices[k] == scales[i] * unit->mesh->vertices[k]);
            starg_decomposition_free(context, d);
        }
        starg_decomposition_free(context, unit);
    }
    test_context_free(context);
}

/* ---- solids ---- */

static starg_decomposition *cut_sample(int threads, const char *name, const double *guards,
                                       size_t count, starg_context **context) {
    *context = test_context(threads);
    starg_tetmesh *mesh = sample_tetmesh(*context, name, 3000);
    starg_decompose_options options = paper_options();
    starg_decomposition *d = NULL;
    options.guards = guards;
    options.guard_count = count;
    test_ok(*context, starg_decompose_tetmesh(*context, mesh, &options, &d));
    check_mesh(*context, mesh, d->mesh);
    starg_tetmesh_free(mesh);
    return d;
}

/* With the guards of section 3 more than 99 % is visible, for any number of threads. */
static void test_threads(void **state) {
    (void)state;
    starg_context *one, *four;
    starg_decomposition *a = cut_sample(1, "torus", NULL, 0, &one);
    starg_decomposition *b = cut_sample(4, "torus", NULL, 0, &four);
    decomposition_oracle_check(a);
    decomposition_oracle_check_connected(a);
    assert_true(a->visible_vertices > 0.99);
    assert_in_range(a->piece_count, 2, 12);
    assert_int_equal(a->piece_count, b->piece_count);
    assert_memory_equal(a->labels, b->labels, sizeof *a->labels * a->mesh->count);
    assert_memory_equal(a->mesh->vertices, b->mesh->vertices, 24 * a->mesh->vertex_count);
    for (size_t p = 0; p < a->piece_count; p++)
        assert_memory_equal(a->pieces[p].guard, b->pieces[p].guard, 24);
    assert_true(a->visible_vertices == b->visible_vertices);
    starg_decomposition_free(one, a);
    starg_decomposition_free(four, b);
    test_context_free(one);
    test_context_free(four);
}

/* Without initial guards, everything is one component that is guarded again. */
static void test_no_guards(void **state) {
    (void)state;
    starg_context *context;
    const double nowhere[] = {1e9, 0, 0};
    starg_decomposition *d = cut_sample(2, "torus", nowhere, 1, &context);
    decomposition_oracle_check(d);
    assert_true(d->visible_vertices > 0.99);
    assert_in_range(d->piece_count, 3, 16);
    starg_decomposition_free(context, d);
    test_context_free(context);
}

static void test_max_pieces(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_tetmesh *mesh = sample_tetmesh(context, "torus", 3000);
    starg_decompose_options options = paper_options();
    const double nowhere[] = {1e9, 0, 0};
    for (size_t most = 1; most <= 3; most++)
        for (int given = 0; given < 2; given++) {
            starg_decomposition *d = NULL;
            options.max_pieces = most;
            options.guards = given ? nowhere : NULL;
            options.guard_count = 1;
            test_ok(context, starg_decompose_tetmesh(context, mesh, &options, &d));
            assert_in_range(d->piece_count, 1, most);
            starg_decomposition_free(context, d);
        }
    starg_tetmesh_free(mesh);
    test_context_free(context);
}

/* A convex solid is one piece, seen from anywhere; separate components need a guard each. */
static void test_convex_and_parts(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(2), other = shape_cube(1);
    for (int parts = 1; parts <= 2; parts++) {
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        starg_decomposition *d = NULL;
        starg_decompose_options options = paper_options();
        options.max_pieces = 1;
        if (parts == 2)
            shape_append(&s, &other, (const double[]){5, 0, 0}, 0);
        test_ok(context, starg_mesh_create(context, s.vertices, s.vertex_count, s.faces,
                                           s.face_count, &mesh));
        test_ok(context, starg_solid_create(context, mesh, &solid));
        test_ok(context, starg_decompose(context, solid, &options, &d));
        decomposition_oracle_check(d);
        assert_int_equal(d->piece_count, parts);
        assert_int_equal(d->strictly_star, parts);
        assert_true(d->visible_vertices == 1);
        starg_decomposition_free(context, d);
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    shape_free(&s);
    shape_free(&other);
    test_context_free(context);
}

/* ---- smoothing ---- */

/* Random regions before and after smoothing: no guard sees less, no star-shaped piece is lost. */
static void test_smoothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t moved = 0;
    for (uint64_t seed = 0; seed < 12; seed++) {
        starg_rng rng = starg_rng_make(seed, 32, 0);
        paper_state s = {.context = context};
        starg_tetmesh *before = random_tetmesh(context, seed, 60 + 3 * seed, false, 1);
        double guards[6];
        test_ok(context, tetmesh_copy(context, before, &s.mesh));
        test_ok(context, tet_sight_create(context, s.mesh, &s.sight));
        test_ok(context, tet_rings_create(context, s.mesh, &s.rings));
        s.labels = starg_allocate(context, before->count, sizeof *s.labels);
        assert_non_null(s.labels);
        double cut = 0.3 + 0.4 * starg_rng_unit(&rng);
        for (size_t t = 0; t < before->count; t++)
            s.labels[t] =
                tetmesh_corner(before, t, 0)[0] + tetmesh_corner(before, t, 1)[0] > 2 * cut;
        s.labels[0] = 0;
        s.labels[before->count - 1] = 1;
        for (size_t i = 0; i < 6; i++)
            guards[i] = 0.25 + 0.5 * starg_rng_unit(&rng);
        s.guards.data = guards;
        s.guards.count = 6;

        starg_decomposition *a = NULL, *b = NULL;
        starg_tetmesh *copy = NULL;
        int32_t *labels = starg_allocate(context, before->count, sizeof *labels);
        assert_non_null(labels);
        memcpy(labels, s.labels, before->count * sizeof *labels);
        test_ok(context, tetmesh_copy(context, before, &copy));
        test_ok(context,
                decomposition_finish(context, STARG_DECOMPOSE_PAPER, copy, labels, guards, 2, &a));
        test_ok(context, smooth_borders(&s));
        check_mesh(context, before, s.mesh);
        tet_sight_free(&s.sight);
        tet_rings_free(&s.rings);
        test_ok(context, decomposition_finish(context, STARG_DECOMPOSE_PAPER, s.mesh, s.labels,
                                              guards, 2, &b));
        assert_true(b->visible_vertices >= a->visible_vertices);
        for (size_t p = 0; p < 2; p++)
            assert_true(b->pieces[p].star || !a->pieces[p].star);
        moved += memcmp(before->vertices, b->mesh->vertices, 24 * before->vertex_count) != 0;
        starg_decomposition_free(context, a);
        starg_decomposition_free(context, b);
        starg_tetmesh_free(before);
    }
    assert_true(moved > 4);
    test_context_free(context);
}

/* ---- memory ---- */

static bool run_rationed(size_t ration) {
    size_t left = SIZE_MAX;
    double guards[3 * 6];
    starg_context *context = test_scarce_context(1, &left);
    starg_decomposition *d = NULL;
    starg_decompose_options options = paper_options();
    starg_tetmesh *mesh = random_tetmesh(context, 7, 30, false, 1);
    options.guards = guards;
    options.guard_count = random_guards(mesh, 3, guards);
    left = ration;
    starg_status status = starg_decompose_tetmesh(context, mesh, &options, &d);
    assert_int_equal(d != NULL, status == STARG_OK);
    if (status != STARG_OK)
        assert_int_equal(status, STARG_ERROR_MEMORY);
    starg_decomposition_free(context, d);
    starg_tetmesh_free(mesh);
    test_context_free(context);
    return status == STARG_OK;
}

static void test_memory(void **state) {
    (void)state;
    size_t ration = 0;
    while (!run_rationed(ration))
        ration++;
    assert_in_range(ration, 40, 5000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),     cmocka_unit_test(test_scales),
        cmocka_unit_test(test_threads),    cmocka_unit_test(test_no_guards),
        cmocka_unit_test(test_max_pieces), cmocka_unit_test(test_convex_and_parts),
        cmocka_unit_test(test_smoothing),  cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
