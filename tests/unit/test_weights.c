/* SPDX-License-Identifier: Apache-2.0 */
/* Weights of faces do not depend on the size of the model. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "guard/candidates.h"
#include "models.h"

static starg_mesh *scaled(starg_context *context, const starg_mesh *mesh, int exponent) {
    size_t count = starg_mesh_vertex_count(mesh);
    double *vertices = malloc(3 * count * sizeof *vertices);
    starg_mesh *out = NULL;
    assert_non_null(vertices);
    for (size_t i = 0; i < 3 * count; i++)
        vertices[i] = ldexp(starg_mesh_vertices(mesh)[i], exponent);
    test_ok(context, starg_mesh_create(context, vertices, count, starg_mesh_faces(mesh),
                                       starg_mesh_face_count(mesh), &out));
    free(vertices);
    return out;
}

static void test_sizes(void **state) {
    (void)state;
    static const int exponents[] = {-900, -530, -1, 300};
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "gallery", 500);
    size_t faces = starg_mesh_face_count(mesh);
    column_weights plain, other;
    const starg_solid given = {.mesh = mesh}; /* so small a mesh is not accepted as a solid */
    test_ok(context, column_weights_create(context, &given, STARG_TARGET_FACES, &plain));
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++) {
        starg_mesh *sized = scaled(context, mesh, exponents[i]);
        const starg_solid small = {.mesh = sized};
        test_ok(context, column_weights_create(context, &small, STARG_TARGET_FACES, &other));
        assert_memory_equal(other.weights, plain.weights, faces * sizeof *plain.weights);
        assert_memory_equal(other.areas, plain.areas, faces * sizeof *plain.areas);
        column_weights_free(&other);
        starg_mesh_free(sized);
    }
    column_weights_free(&plain);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* The verifier, which has its own scale, confirms the claims about areas. */
static void test_tiny(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "gallery", 500),
               *tiny = scaled(context, mesh, -290);
    starg_solid *solid = NULL;
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.method = STARG_GUARD_GREEDY;
    options.candidates = STARG_CANDIDATES_GIVEN;
    options.coverage = 0.5;
    test_ok(context, starg_solid_create(context, tiny, &solid));
    double *points = NULL;
    starg_solid *plain = NULL;
    test_ok(context, starg_solid_create(context, mesh, &plain));
    test_ok(context, starg_candidate_points(context, plain, STARG_CANDIDATES_INTERIOR, 50, 0,
                                            &points, &options.point_count));
    for (size_t i = 0; i < 3 * options.point_count; i++)
        points[i] = ldexp(points[i], -290);
    options.points = points;
    starg_guards *guards = test_guard(context, solid, &options);
    assert_true(guards->coverage_area >= 0.5 && guards->coverage_area < 1);
    starg_guards_free(context, guards);
    starg_points_free(context, points);
    starg_solid_free(plain);
    starg_solid_free(solid);
    starg_mesh_free(tiny);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sizes), cmocka_unit_test(test_tiny)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
