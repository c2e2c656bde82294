/* SPDX-License-Identifier: Apache-2.0 */
/* Delaunay tetrahedra against the definition: no point strictly inside a sphere, and the volumes
 * add up to that of the hull (computed by a second triangulation in another order). */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "geometry/delaunay.h"

/* Brute force by the exact oracle: every point against every sphere. */
static void check_empty_spheres(const delaunay *d, const double *points, size_t count) {
    for (size_t t = 0; t < d->count; t++) {
        const double *v[4];
        for (int k = 0; k < 4; k++)
            v[k] = points + 3 * (size_t)d->tetrahedra[t][k];
        assert_int_equal(oracle_orient3d(v[0], v[1], v[2], v[3]), 1);
        for (size_t i = 0; i < count; i++)
            assert_true(oracle_insphere(v[0], v[1], v[2], v[3], points + 3 * i) <= 0);
    }
}

static double volume_of(const delaunay *d, const double *points) {
    double sum = 0;
    for (size_t t = 0; t < d->count; t++) {
        double m[3][3];
        for (int k = 0; k < 3; k++)
            for (int j = 0; j < 3; j++)
                m[k][j] = points[3 * (size_t)d->tetrahedra[t][k] + (size_t)j] -
                          points[3 * (size_t)d->tetrahedra[t][3] + (size_t)j];
        sum += m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    }
    return sum / 6;
}

/* Every inner face must have two tetrahedra, on opposite sides: with positive volumes and empty
 * spheres these tile the hull. */
static void check_faces(const delaunay *d, size_t count) {
    size_t faces = 4 * d->count;
    uint64_t *keys = malloc(faces * sizeof *keys);
    assert_non_null(keys);
    for (size_t t = 0; t < d->count; t++)
        for (size_t k = 0; k < 4; k++) {
            uint64_t v[3], n = 0;
            for (size_t j = 0; j < 4; j++)
                if (j != k)
                    v[n++] = d->tetrahedra[t][j];
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2 - a; b++)
                    if (v[b] > v[b + 1]) {
                        uint64_t swap = v[b];
                        v[b] = v[b + 1];
                        v[b + 1] = swap;
                    }
            keys[4 * t + k] = (v[0] * count + v[1]) * count + v[2];
        }
    for (size_t i = 0; i < faces; i++) {
        int same = 0;
        for (size_t j = 0; j < faces; j++)
            same += keys[i] == keys[j];
        assert_in_range(same, 1, 2);
    }
    free(keys);
}

/* Neighbours are mutual and share the three points of their common face, and exactly the faces of a
 * single tetrahedron have no neighbour. */
static void check_neighbours(const delaunay *d) {
    for (uint32_t t = 0; t < d->count; t++)
        for (int k = 0; k < 4; k++) {
            size_t sharing = 0;
            for (uint32_t other = 0; other < d->count; other++) {
                int shared = 0, back = 0;
                for (int j = 0; j < 4; j++)
                    for (int i = 0; i < 4; i++)
                        shared += i != k && d->tetrahedra[t][i] == d->tetrahedra[other][j];
                if (other == t || shared < 3)
                    continue;
                sharing++;
                assert_int_equal(d->neighbours[t][k], other);
                for (int j = 0; j < 4; j++)
                    back += d->neighbours[other][j] == t;
                assert_int_equal(back, 1);
            }
            assert_int_equal(sharing, d->neighbours[t][k] != DELAUNAY_NONE);
        }
}

static void run(starg_context *context, const double *points, size_t count, double hull) {
    delaunay *d = NULL;
    test_ok(context, delaunay_create(context, points, count, &d));
    check_empty_spheres(d, points, count);
    check_faces(d, count);
    check_neighbours(d);
    if (hull >= 0)
        assert_true(fabs(volume_of(d, points) - hull) <= 1e-9 * (1 + hull));
    delaunay_free(d);
}

/* Lattice points are often cospherical, coplanar or coincident; the corners fix the hull. */
static void test_lattice(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 25; seed++) {
        double points[3 * 45];
        size_t count = 12 + seed;
        starg_rng rng = starg_rng_make(7, 1, seed);
        for (size_t i = 0; i < 3 * count; i++)
            points[i] = (double)starg_rng_below(&rng, 4);
        for (size_t i = 0; i < 24; i++)
            points[i] = (double)((i / 3) >> (i % 3) & 1) * 3;
        run(context, points, count, 27);
    }
    test_context_free(context);
}

static void test_random(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0, most = test_rounds(5, 8); seed < most; seed++) {
        double points[3 * 80];
        starg_rng rng = starg_rng_make(7, 2, seed);
        for (size_t i = 0; i < 3 * 80; i++)
            points[i] = starg_rng_unit(&rng) * (seed % 2 ? 1 : 1e-90);
        for (size_t i = 0; i < 24; i++)
            points[i] = (double)((i / 3) >> (i % 3) & 1) * (seed % 2 ? 1 : 1e-90);
        run(context, points, 80, seed % 2 ? 1 : -1);
    }
    test_context_free(context);
}

/* All on one sphere, up to rounding. */
static void test_sphere(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double points[3 * 70];
    for (size_t i = 0; i < 70; i++) {
        double z = 1 - (2 * (double)i + 1) / 70, r = sqrt(1 - z * z), t = 2.4 * (double)i;
        points[3 * i] = r * cos(t);
        points[3 * i + 1] = r * sin(t);
        points[3 * i + 2] = z;
    }
    run(context, points, 70, -1);
    test_context_free(context);
}

static void test_flat(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double plane[] = {0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1, 0.5, 0.25, 1};
    delaunay *d = NULL;
    for (size_t count = 0; count <= 5; count++) {
        test_ok(context, delaunay_create(context, plane, count, &d));
        assert_int_equal(d->count, 0);
        delaunay_free(d);
    }
    test_context_free(context);
}

/* A copy and its original continue independently, and both end as if the other did not exist. */
static void test_copy(void **state) {
    (void)state;
    enum { FIRST = 25, COUNT = 50 };
    starg_context *context = test_context(1);
    double points[2][3 * COUNT]; /* equal at first, later not */
    starg_rng rng = starg_rng_make(7, 3, 0);
    for (size_t i = 0; i < 3 * COUNT; i++) {
        points[0][i] = points[1][i] = (double)starg_rng_below(&rng, 6);
        if (i >= (size_t)3 * FIRST)
            points[1][i] = starg_rng_unit(&rng) * 5;
    }
    delaunay_builder *builders[2];
    test_ok(context, delaunay_begin(context, points[0], FIRST, &builders[0]));
    test_ok(context, delaunay_copy(builders[0], &builders[1]));
    for (int i = 0; i < 2; i++)
        test_ok(context, delaunay_extend(builders[i], points[i], COUNT));
    for (int i = 0; i < 2; i++) {
        delaunay *both = NULL, *alone = NULL;
        delaunay_builder *builder = NULL;
        test_ok(context, delaunay_finish(builders[i], &both));
        delaunay_builder_free(builders[i]);
        check_empty_spheres(both, points[i], COUNT);
        check_neighbours(both);
        test_ok(context, delaunay_begin(context, points[i], FIRST, &builder));
        test_ok(context, delaunay_extend(builder, points[i], COUNT));
        test_ok(context, delaunay_finish(builder, &alone));
        delaunay_builder_free(builder);
        assert_int_equal(both->count, alone->count);
        assert_memory_equal(both->tetrahedra, alone->tetrahedra,
                            alone->count * sizeof *alone->tetrahedra);
        delaunay_free(alone);
        delaunay_free(both);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lattice),
                                       cmocka_unit_test(test_random), cmocka_unit_test(test_sphere),
                                       cmocka_unit_test(test_flat), cmocka_unit_test(test_copy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
