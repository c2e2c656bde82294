/* SPDX-License-Identifier: Apache-2.0 */
/* Spherical embeddings: are they bijections? Are landmarks met? */
#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "morph/surface_map.h"
#include "sphere/sphere.h"
#include "starguard/morph.h"
#include "starguard/sample.h"

/* Sign of det(a, b, c) in rational numbers. */
static int slow_sign(const double *a, const double *b, const double *c) {
    mpq_t sum, term, factor;
    mpq_inits(sum, term, factor, NULL);
    for (int i = 0; i < 3; i++)
        for (int turn = 1; turn <= 2; turn++) {
            mpq_set_d(term, a[i]);
            mpq_set_d(factor, b[(i + turn) % 3]);
            mpq_mul(term, term, factor);
            mpq_set_d(factor, c[(i + 3 - turn) % 3]);
            mpq_mul(term, term, factor);
            if (turn == 1)
                mpq_add(sum, sum, term);
            else
                mpq_sub(sum, sum, term);
        }
    int sign = mpq_sgn(sum);
    mpq_clears(sum, term, factor, NULL);
    return sign;
}

/* All faces are positive, and generic directions are covered once: together a bijection. */
static void assert_bijective(const sphere *s) {
    const uint32_t *faces = starg_mesh_faces(s->mesh);
    starg_rng rng = starg_rng_make(5, 0, 0);
    for (size_t f = 0; f < starg_mesh_face_count(s->mesh); f++)
        assert_int_equal(slow_sign(s->directions + 3 * (size_t)faces[3 * f],
                                   s->directions + 3 * (size_t)faces[3 * f + 1],
                                   s->directions + 3 * (size_t)faces[3 * f + 2]),
                         1);
    for (int i = 0; i < 5; i++) {
        double x[3];
        size_t covered = 0;
        for (int k = 0; k < 3; k++)
            x[k] = starg_rng_unit(&rng) - 0.5;
        for (size_t f = 0; f < starg_mesh_face_count(s->mesh); f++) {
            bool inside = true;
            for (size_t k = 0; k < 3 && inside; k++)
                inside = slow_sign(s->directions + 3 * (size_t)faces[3 * f + k],
                                   s->directions + 3 * (size_t)faces[3 * f + (k + 1) % 3], x) > 0;
            covered += inside;
        }
        assert_int_equal(covered, 1);
    }
}

static void assert_spreads(starg_context *context, const starg_mesh *mesh) {
    starg_mesh *unit;
    sphere *s;
    test_ok(context, map_unit_copy(context, mesh, &unit));
    test_ok(context, sphere_create(context, unit, &s));
    assert_bijective(s);
    sphere_free(s);
    starg_mesh_free(unit);
}

static void test_samples(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (size_t i = 0; i < starg_sample_count(); i += test_step()) {
        if (starg_sample_at(i)->scene)
            continue;
        starg_mesh *mesh = test_sample_mesh(context, starg_sample_at(i)->name, 700);
        starg_check *check;
        test_ok(context, starg_mesh_check(context, mesh, &check));
        if (check->genus == 0 && check->components == 1)
            assert_spreads(context, mesh);
        starg_check_free(context, check);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* The smallest surface, a lattice with flat fans, and a double cone with a vertex of high
 * degree. */
static void test_special(void **state) {
    (void)state;
    enum { RIM = 400 };
    starg_context *context = test_context(1);
    shape shapes[] = {shape_tetrahedron(), shape_cube(1), shape_cube(4), shape_room(),
                      shape_blob(3, 7)};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        starg_mesh *mesh = test_mesh_of(context, &shapes[i]);
        assert_spreads(context, mesh);
        starg_mesh_free(mesh);
        shape_free(&shapes[i]);
    }
    static double vertices[3 * (RIM + 2)];
    static uint32_t faces[3 * 2 * RIM];
    vertices[3 * RIM + 2] = 1;
    vertices[3 * RIM + 5] = -1e-3;
    for (uint32_t i = 0; i < RIM; i++) {
        uint32_t j = (i + 1) % RIM;
        vertices[3 * i] = cos(2 * acos(-1) * i / RIM);
        vertices[3 * i + 1] = sin(2 * acos(-1) * i / RIM);
        memcpy(faces + 6 * i, (const uint32_t[6]){i, j, RIM, j, i, RIM + 1}, 6 * sizeof *faces);
    }
    starg_mesh *cone;
    test_ok(context, starg_mesh_create(context, vertices, RIM + 2, faces, 2 * RIM, &cone));
    assert_spreads(context, cone);
    starg_mesh_free(cone);
    test_context_free(context);
}

static uint32_t nearest_vertex(const starg_mesh *mesh, const double *p) {
    uint32_t best = 0;
    double least = INFINITY;
    for (uint32_t v = 0; v < starg_mesh_vertex_count(mesh); v++) {
        const double *q = starg_mesh_vertices(mesh) + 3 * (size_t)v;
        double d = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
        if (d < least) {
            least = d;
            best = v;
        }
    }
    return best;
}

/* Random pairs of vertices as landmarks: if met, exactly, and without a fold. */
static void test_landmarks(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "cat", 900),
               *b = test_sample_mesh(context, "sphere", 800);
    starg_mesh *unit_a, *unit_b;
    size_t met = 0;
    test_ok(context, map_unit_copy(context, a, &unit_a));
    test_ok(context, map_unit_copy(context, b, &unit_b));
    for (uint64_t round = 0; round < 6; round++) {
        sphere *from, *to;
        starg_rng rng = starg_rng_make(3, round, 0);
        uint32_t pairs[2][4];
        size_t count = 1 + round % 4;
        for (size_t i = 0; i < count; i++) {
            pairs[0][i] = (uint32_t)starg_rng_below(&rng, starg_mesh_vertex_count(a));
            pairs[1][i] = (uint32_t)starg_rng_below(&rng, starg_mesh_vertex_count(b));
        }
        const landmark_list marks = {pairs[0], pairs[1], count};
        test_ok(context, sphere_create(context, unit_a, &from));
        test_ok(context, sphere_create(context, unit_b, &to));
        bool all_met;
        test_ok(context, landmarks_meet(from, to, &marks, &all_met));
        if (all_met) {
            met++;
            for (size_t i = 0; i < count; i++)
                assert_memory_equal(from->directions + 3 * (size_t)pairs[0][i],
                                    to->directions + 3 * (size_t)pairs[1][i],
                                    3 * sizeof *from->directions);
        } else {
            assert_int_equal(landmarks_contradict(from, to, &marks), STARG_ERROR_MESH);
        }
        assert_bijective(from);
        sphere_free(from);
        sphere_free(to);
    }
    assert_true(met >= 4);
    starg_mesh_free(unit_a);
    starg_mesh_free(unit_b);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* One shape, meshed twice: with a few landmarks the map is close to the identity, and a bijection.
 * Without relaxation of the composed map, angles are off by far more. */
static void test_composed(void **state) {
    (void)state;
    enum { MARKS = 8 };
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "cat", 700),
               *b = test_sample_mesh(context, "cat", 1100);
    starg_mesh *unit_a, *unit_b;
    starg_map *map;
    uint32_t pairs[2 * MARKS];
    for (uint32_t i = 0; i < MARKS; i++) {
        pairs[2 * i] = i * (uint32_t)(starg_mesh_vertex_count(a) / MARKS);
        pairs[2 * i + 1] = nearest_vertex(b, starg_mesh_vertices(a) + 3 * (size_t)pairs[2 * i]);
    }
    const starg_map_options options = {.landmarks = pairs, .landmark_count = MARKS};
    test_ok(context, starg_map_create(context, a, b, &options, &map));
    assert_true(map->mean_angle_distortion < 1.15);
    assert_true(map->mean_area_distortion < 1.15);
    assert_int_equal(map->collapsed, 0);
    starg_map_free(context, map);

    sphere *from, *to;
    locator where;
    bool met;
    uint32_t lists[2][MARKS];
    for (size_t i = 0; i < 2 * MARKS; i++)
        lists[i % 2][i / 2] = pairs[i];
    const landmark_list marks = {lists[0], lists[1], MARKS};
    feature_pairs features;
    test_ok(context, map_unit_copy(context, a, &unit_a));
    test_ok(context, map_unit_copy(context, b, &unit_b));
    test_ok(context, sphere_create(context, unit_a, &from));
    test_ok(context, sphere_create(context, unit_b, &to));
    test_ok(context, locator_create(context, to, &where));
    test_ok(context, align_spheres(from, &where, &marks, &features));
    test_ok(context, compose_spheres(from, &where, &marks, &met));
    assert_true(met);
    assert_bijective(from);
    for (size_t i = 0; i < MARKS; i++)
        assert_memory_equal(from->directions + 3 * (size_t)lists[0][i],
                            to->directions + 3 * (size_t)lists[1][i], 3 * sizeof *from->directions);
    locator_free(&where);
    sphere_free(from);
    sphere_free(to);
    starg_mesh_free(unit_a);
    starg_mesh_free(unit_b);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* The map meets its landmarks exactly at the vertices, and its places are valid points of faces. */
static void test_map_landmarks(void **state) {
    (void)state;
    static const uint32_t pairs[] = {10, 20, 300, 410, 555, 123};
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "sphere", 700),
               *b = test_sample_mesh(context, "bird", 600);
    const starg_map_options options = {.landmarks = pairs, .landmark_count = 3};
    starg_map *map;
    test_ok(context, starg_map_create(context, a, b, &options, &map));
    double *images = malloc(3 * map->vertex_count * sizeof *images);
    assert_non_null(images);
    starg_map_positions(map, b, images);
    for (size_t i = 0; i < 3; i++)
        assert_memory_equal(images + 3 * (size_t)pairs[2 * i],
                            starg_mesh_vertices(b) + 3 * (size_t)pairs[2 * i + 1],
                            3 * sizeof *images);
    for (size_t v = 0; v < map->vertex_count; v++) {
        const double *w = map->coordinates + 3 * v;
        assert_true(map->faces[v] < starg_mesh_face_count(b));
        assert_true(w[0] >= 0 && w[1] >= 0 && w[2] >= 0 && fabs(w[0] + w[1] + w[2] - 1) < 1e-12);
    }
    free(images);
    starg_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* Models with fingers, ears and crevices. */
static void test_shared(void **state) {
    (void)state;
    static const char *const files[] = {"solids/hand_1197.off", "solids/knight_502.off",
                                        "solids/octopus_124.off", "table2/bunny_998.off",
                                        "poses/tosca_wolf0.off"};
    const char *data = test_shared_data();
    if (data == NULL) {
        skip();
        return;
    }
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[4400];
        starg_mesh *mesh;
        snprintf(path, sizeof path, "%s/%s", data, files[i]);
        test_ok(context, starg_mesh_read(context, path, &mesh));
        assert_spreads(context, mesh);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_samples),       cmocka_unit_test(test_special),
        cmocka_unit_test(test_landmarks),     cmocka_unit_test(test_composed),
        cmocka_unit_test(test_map_landmarks), cmocka_unit_test(test_shared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
