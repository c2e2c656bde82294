/* SPDX-License-Identifier: Apache-2.0 */
/* Levels of detail for descriptors: noise disappears, the shape stays. */
#include "shape/measures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/check.h"
#include "starguard/solid.h"

/* Moves every coordinate at random by up to `step`. */
static starg_mesh *shaken(starg_context *context, const starg_mesh *mesh, double step) {
    starg_rng rng = starg_rng_make(31, 0, 0);
    starg_mesh *out = NULL;
    size_t count = 3 * starg_mesh_vertex_count(mesh);
    double *moved = malloc(count * sizeof *moved);
    assert_non_null(moved);
    for (size_t i = 0; i < count; i++)
        moved[i] = starg_mesh_vertices(mesh)[i] + step * (2 * starg_rng_unit(&rng) - 1);
    test_ok(context, starg_mesh_create(context, moved, count / 3, starg_mesh_faces(mesh),
                                       starg_mesh_face_count(mesh), &out));
    free(moved);
    return out;
}

/* Root mean square distance of the vertices from the unit sphere. */
static double off_the_sphere(const starg_mesh *mesh) {
    double sum = 0;
    size_t n = starg_mesh_vertex_count(mesh);
    for (size_t i = 0; i < n; i++) {
        const double *p = starg_mesh_vertices(mesh) + 3 * i;
        sum += pow(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1, 2);
    }
    return sqrt(sum / (double)n);
}

static void noise_goes_and_volume_stays(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 4000);
    starg_mesh *noisy = shaken(context, mesh, 0.02), *level = NULL;
    assert_true(off_the_sphere(mesh) < 1e-6);
    test_ok(context, level_create(context, noisy, 1000, &level));
    assert_non_null(level);
    assert_true(starg_mesh_vertex_count(level) <= 1000);
    assert_true(off_the_sphere(level) < 0.5 * off_the_sphere(noisy));
    assert_true(fabs(starg_mesh_volume(level) / starg_mesh_volume(mesh) - 1) < 0.01);
    starg_mesh_free(level);
    starg_mesh_free(noisy);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Whatever comes of noise bounds a solid without self-intersections. */
static void noisy_figures_bound_solids(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const char *names[] = {"horse", "octopus", "human"};
    for (size_t i = 0; i < 3; i++) {
        starg_mesh *mesh = test_sample_mesh(context, names[i], 3000), *level = NULL;
        double lower[3], upper[3], diagonal = 0;
        starg_check *before = NULL, *after = NULL;
        starg_mesh_bounds(mesh, lower, upper);
        for (int k = 0; k < 3; k++)
            diagonal += pow(upper[k] - lower[k], 2);
        starg_mesh *noisy = shaken(context, mesh, 0.005 * sqrt(diagonal));
        test_ok(context, level_create(context, noisy, 1000, &level));
        assert_non_null(level);
        test_ok(context, starg_mesh_check(context, noisy, &before));
        test_ok(context, starg_mesh_check(context, level, &after));
        assert_true(!before->embedded && after->embedded);
        assert_true(after->usable);
        assert_true(fabs(starg_mesh_volume(level) / starg_mesh_volume(mesh) - 1) < 0.1);
        starg_check_free(context, before);
        starg_check_free(context, after);
        starg_mesh_free(level);
        starg_mesh_free(noisy);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* Coarse meshes are not smoothed; meshes that are not closed manifolds are left alone. */
static void coarse_and_open_meshes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1);
    starg_mesh *cube = test_mesh_of(context, &s), *level = NULL;
    test_ok(context, level_create(context, cube, 1000, &level));
    assert_int_equal(starg_mesh_vertex_count(level), 8);
    assert_true(starg_mesh_volume(level) == 1);
    starg_mesh_free(level);
    s.face_count--;
    starg_mesh *open = test_mesh_of(context, &s);
    test_ok(context, level_create(context, open, 1000, &level));
    assert_null(level);
    starg_mesh_free(open);
    starg_mesh_free(cube);
    shape_free(&s);
    test_context_free(context);
}

static void memory_may_give_out(void **state) {
    (void)state;
    size_t left = SIZE_MAX, failures = 0;
    starg_context *context = test_scarce_context(1, &left);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 500), *level = NULL;
    size_t before = starg_context_live_blocks(context);
    for (starg_status status = STARG_ERROR_MEMORY; status != STARG_OK; failures++) {
        left = failures;
        status = level_create(context, mesh, 250, &level);
        left = SIZE_MAX;
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_true(status == STARG_OK ||
                    (level == NULL && starg_context_live_blocks(context) == before));
    }
    assert_true(failures > 20);
    starg_mesh_free(level);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void cancelled(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "sphere", 1000), *level = NULL;
    starg_context_cancel(context);
    assert_int_equal(level_create(context, mesh, 500, &level), STARG_ERROR_CANCELLED);
    assert_null(level);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_goes_and_volume_stays),
        cmocka_unit_test(noisy_figures_bound_solids),
        cmocka_unit_test(coarse_and_open_meshes),
        cmocka_unit_test(memory_may_give_out),
        cmocka_unit_test(cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
