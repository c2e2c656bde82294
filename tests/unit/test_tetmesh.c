/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedral meshes: exactly what the definition allows is accepted; neighbours by brute force,
 * boundary and volume against each other. */
#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "geometry/delaunay.h"
#include "starguard/check.h"
#include "starguard/tetra.h"

/* Two tetrahedra on the face 0 1 2, then one far away. */
static const double POINTS[] = {0,  0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0,
                                -1, 5, 5, 5, 6, 5, 5, 5, 6, 5, 5, 5, 6};
enum { POINT_COUNT = 9 };

static starg_status make(starg_context *context, const double *points, size_t point_count,
                         const uint32_t *tetrahedra, size_t count, starg_tetmesh **out) {
    return starg_tetmesh_create(context, points, point_count, tetrahedra, count, NULL, out);
}

static void expect_fail(starg_context *context, const double *points, size_t point_count,
                        const uint32_t *tetrahedra, size_t count, starg_status status,
                        const uint64_t *indices, size_t index_count) {
    starg_tetmesh *mesh = NULL;
    assert_int_equal(make(context, points, point_count, tetrahedra, count, &mesh), status);
    assert_null(mesh);
    const starg_error *error = starg_context_error(context);
    assert_int_equal(error->index_count, index_count);
    if (index_count > 0)
        assert_int_equal(error->element, STARG_ELEMENT_TETRAHEDRON);
    for (size_t i = 0; i < index_count; i++)
        assert_int_equal(error->indices[i], indices[i]);
}

static void test_basics(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const uint32_t two[] = {0, 1, 2, 3, 0, 1, 2, 4}; /* the second is negative */
    const int32_t regions[] = {7, -2}, same[] = {3, 3};
    starg_tetmesh *mesh = NULL;
    starg_mesh *surface = NULL;
    uint32_t *map = NULL;
    test_ok(context, starg_tetmesh_create(context, POINTS, POINT_COUNT, two, 2, regions, &mesh));
    assert_int_equal(starg_tetmesh_count(mesh), 2);
    assert_int_equal(starg_tetmesh_vertex_count(mesh), POINT_COUNT);
    assert_int_equal(starg_tetmesh_turned(mesh), 1);
    assert_memory_equal(starg_tetmesh_regions(mesh), regions, sizeof regions);
    assert_true(fabs(starg_tetmesh_volume(mesh) - 1.0 / 3) < 1e-15);
    const uint32_t expected[] = {0, 1, 2, 3, 0, 1, 4, 2};
    assert_memory_equal(starg_tetmesh_tetrahedra(mesh), expected, sizeof expected);
    const uint32_t none = STARG_TETMESH_NONE, next[] = {none, none, none, 1, none, none, 0, none};
    assert_memory_equal(starg_tetmesh_neighbours(mesh), next, sizeof next);

    test_ok(context, starg_tetmesh_surface(context, mesh, &surface, &map));
    assert_int_equal(starg_mesh_vertex_count(surface), 5);
    assert_int_equal(starg_mesh_face_count(surface), 6);
    for (uint32_t i = 0; i < 5; i++)
        assert_int_equal(map[i], i);
    assert_true(fabs(starg_mesh_volume(surface) - 1.0 / 3) < 1e-15);
    starg_tetmesh_map_free(context, map);
    starg_mesh_free(surface);
    starg_tetmesh_free(mesh);
    test_ok(context, starg_tetmesh_create(context, POINTS, POINT_COUNT, two, 2, same, &mesh));
    assert_null(starg_tetmesh_regions(mesh)); /* uniform labels are dropped */
    starg_tetmesh_free(mesh);
    starg_tetmesh_free(NULL);
    test_context_free(context);
}

static void test_refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    expect_fail(context, POINTS, POINT_COUNT, NULL, 0, STARG_ERROR_ARGUMENT, NULL, 0);
    const uint32_t beyond[] = {0, 1, 2, 3, 0, 1, 2, 9};
    expect_fail(context, POINTS, POINT_COUNT, beyond, 2, STARG_ERROR_ARGUMENT,
                (const uint64_t[]){1}, 1);
    const uint32_t flat[] = {0, 1, 2, 3, 0, 0, 1, 2, 5, 6, 7, 8, 1, 2, 3, 3};
    expect_fail(context, POINTS, POINT_COUNT, flat, 4, STARG_ERROR_MESH, (const uint64_t[]){1, 3},
                2);
    const uint32_t twice[] = {5, 6, 7, 8, 0, 1, 2, 3, 0, 2, 1, 3};
    expect_fail(context, POINTS, POINT_COUNT, twice, 3, STARG_ERROR_MESH, (const uint64_t[]){1, 2},
                2);
    const double above[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0.1, 2, 0, 0, -1};
    const uint32_t folded[] = {0, 1, 2, 3, 0, 1, 2, 4};
    expect_fail(context, above, 6, folded, 2, STARG_ERROR_MESH, (const uint64_t[]){0, 1}, 2);
    const uint32_t three[] = {0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5};
    expect_fail(context, above, 6, three, 3, STARG_ERROR_MESH, (const uint64_t[]){0, 1, 2}, 3);
    double odd[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, NAN};
    starg_tetmesh *mesh = NULL;
    assert_int_equal(make(context, odd, 4, folded, 1, &mesh), STARG_ERROR_RANGE);
    odd[11] = 1e100;
    assert_int_equal(make(context, odd, 4, folded, 1, &mesh), STARG_ERROR_RANGE);
    test_context_free(context);
}

/* One tetrahedron, translated and scaled, next to the standard one: overlapping or not. */
static starg_status beside(starg_context *context, double scale, const double offset[3],
                           starg_tetmesh **mesh) {
    static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double points[24];
    const uint32_t tetrahedra[] = {0, 1, 2, 3, 4, 5, 6, 7};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            points[3 * i + k] = corner[i][k];
            points[12 + 3 * i + k] = scale * corner[i][k] + offset[k];
        }
    return make(context, points, 8, tetrahedra, 2, mesh);
}

static void test_overlap_elsewhere(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const struct {
        double scale, offset[3];
        bool overlap;
    } cases[] = {
        {1, {3, 0, 0}, false},         {1, {0.25, 0.25, 0.25}, true}, /* crossing faces */
        {0.1, {0.2, 0.2, 0.2}, true},                                 /* one inside the other */
        {10, {-1, -1, -1}, true},      {1, {1, 0, 0}, false},         /* touch in a corner */
        {-1, {0, 0, 0}, false},                                       /* corner to corner */
        {1, {0, 0, 0}, true},                                         /* the same place */
        {0.5, {0.5, 0, 0}, true},                                     /* shares parts of faces */
        {-0.5, {0.5, 0.5, 0.0}, true}, /* edge on the face from inside and outside */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        starg_tetmesh *mesh = NULL;
        starg_status status = beside(context, cases[i].scale, cases[i].offset, &mesh);
        assert_int_equal(status, cases[i].overlap ? STARG_ERROR_MESH : STARG_OK);
        assert_int_equal(mesh != NULL, status == STARG_OK);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

/* Delaunay tetrahedra of random points, some omitted: always a mesh. */
static starg_tetmesh *random_mesh(starg_context *context, uint64_t seed, size_t points_wanted,
                                  bool lattice) {
    starg_rng rng = starg_rng_make(seed, 11, 0);
    double points[3 * 100];
    delaunay *d = NULL;
    starg_tetmesh *mesh = NULL;
    for (size_t i = 0; i < 3 * points_wanted; i++)
        points[i] = lattice ? (double)starg_rng_below(&rng, 4) : starg_rng_unit(&rng);
    test_ok(context, delaunay_create(context, points, points_wanted, &d));
    uint32_t *kept = malloc(16 * d->count + 16);
    assert_non_null(kept);
    size_t count = 0;
    for (size_t t = 0; t < d->count; t++)
        if (starg_rng_below(&rng, 4) > 0)
            memcpy(kept + 4 * count++, d->tetrahedra[t], 16);
    if (count > 0)
        test_ok(context, make(context, points, points_wanted, kept, count, &mesh));
    free(kept);
    delaunay_free(d);
    return mesh;
}

static void check_neighbours(const starg_tetmesh *mesh) {
    const uint32_t *v = starg_tetmesh_tetrahedra(mesh), *next = starg_tetmesh_neighbours(mesh);
    size_t count = starg_tetmesh_count(mesh);
    for (uint32_t t = 0; t < count; t++)
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t expected = STARG_TETMESH_NONE;
            for (uint32_t u = 0; u < count && expected == STARG_TETMESH_NONE; u++) {
                int shared = 0;
                for (uint32_t j = 0; j < 4; j++)
                    for (uint32_t i = 0; i < 4; i++)
                        shared += i != k && v[4 * t + i] == v[4 * u + j];
                if (u != t && shared == 3)
                    expected = u;
            }
            assert_int_equal(next[4 * t + k], expected);
        }
}

static void test_random(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t made = 0;
    for (uint64_t seed = 0; seed < 24; seed++) {
        starg_tetmesh *mesh = random_mesh(context, seed, 8 + seed, seed % 2 == 1);
        if (mesh == NULL)
            continue;
        made++;
        const uint32_t *v = starg_tetmesh_tetrahedra(mesh);
        const double *p = starg_tetmesh_vertices(mesh);
        for (size_t t = 0; t < starg_tetmesh_count(mesh); t++)
            assert_int_equal(oracle_orient3d(p + 3 * v[4 * t], p + 3 * v[4 * t + 1],
                                             p + 3 * v[4 * t + 2], p + 3 * v[4 * t + 3]),
                             -1);
        assert_int_equal(starg_tetmesh_turned(mesh), starg_tetmesh_count(mesh));
        check_neighbours(mesh);
        starg_mesh *surface = NULL;
        test_ok(context, starg_tetmesh_surface(context, mesh, &surface, NULL));
        double volume = starg_tetmesh_volume(mesh);
        assert_true(fabs(volume - starg_mesh_volume(surface)) <= 1e-12 * (1 + volume));
        starg_mesh_free(surface);
        starg_tetmesh_free(mesh);
    }
    assert_true(made >= 20);
    test_context_free(context);
}

/* A vertex moved beyond its opposite face folds the mesh: this is detected, or nothing overlaps. */
static void test_moved_vertex(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t refused = 0;
    for (uint64_t seed = 0; seed < 24; seed++) {
        starg_tetmesh *mesh = random_mesh(context, seed, 20, false), *moved = NULL;
        starg_rng rng = starg_rng_make(seed, 12, 0);
        double points[60];
        memcpy(points, starg_tetmesh_vertices(mesh), sizeof points);
        size_t vertex = starg_rng_below(&rng, 20);
        for (size_t k = 0; k < 3; k++)
            points[3 * vertex + k] = 2 * starg_rng_unit(&rng) - 0.5;
        starg_status status = make(context, points, 20, starg_tetmesh_tetrahedra(mesh),
                                   starg_tetmesh_count(mesh), &moved);
        /* by sampling: a point in two tetrahedra is a proof */
        const uint32_t *v = starg_tetmesh_tetrahedra(mesh);
        size_t most = 0;
        for (int sample = 0; sample < 60; sample++) {
            double p[3];
            size_t holding = 0;
            for (int k = 0; k < 3; k++)
                p[k] = 2 * starg_rng_unit(&rng) - 0.5;
            for (size_t t = 0; t < starg_tetmesh_count(mesh); t++) {
                const double *c[4];
                int sides = 0;
                for (int k = 0; k < 4; k++)
                    c[k] = points + 3 * v[4 * t + (size_t)k];
                int own = oracle_orient3d(c[0], c[1], c[2], c[3]);
                sides += oracle_orient3d(c[0], c[1], c[2], p) == own;
                sides += oracle_orient3d(c[0], c[3], c[1], p) == own;
                sides += oracle_orient3d(c[0], c[2], c[3], p) == own;
                sides += oracle_orient3d(c[1], c[3], c[2], p) == own;
                holding += sides == 4;
            }
            most = holding > most ? holding : most;
        }
        if (most > 1)
            assert_int_equal(status, STARG_ERROR_MESH);
        refused += status == STARG_ERROR_MESH;
        starg_tetmesh_free(moved);
        starg_tetmesh_free(mesh);
    }
    assert_true(refused >= 12);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_basics), cmocka_unit_test(test_refused),
        cmocka_unit_test(test_overlap_elsewhere), cmocka_unit_test(test_random),
        cmocka_unit_test(test_moved_vertex)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
