/* SPDX-License-Identifier: Apache-2.0 */
/* The level of detail used for the medial axis of a large model. */
#include "guard/candidates.h"
#include "models.h"
#include "starguard/check.h"
#include "starguard/guard.h"

enum { MESHES = 4 };

/* The level chosen among some of the meshes, the last of which is the model. */
static void expect_level(starg_context *context, starg_mesh *const meshes[MESHES],
                         const size_t *some, size_t count, size_t wanted) {
    starg_level entries[MESHES] = {{.mesh = NULL}};
    starg_solid *chosen = NULL;
    for (size_t i = 0; i < count; i++)
        entries[i].mesh = meshes[some[i]];
    const starg_levels levels = {.count = count, .levels = entries};
    starg_solid *model = NULL;
    test_ok(context, starg_solid_create(context, meshes[some[count - 1]], &model));
    test_ok(context, proxy_of_levels(context, model, &levels, &chosen));
    starg_solid_free(model);
    assert_true(test_same_mesh(starg_solid_mesh(chosen), meshes[some[wanted]]));
    starg_solid_free(chosen);
}

/* The coarsest with 25,000 vertices; the model itself if none has. */
static void test_choice(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    static const size_t vertices[MESHES] = {5000, 24000, 26000, 40000};
    starg_mesh *meshes[MESHES];
    for (size_t i = 0; i < MESHES; i++)
        meshes[i] = test_sample_mesh(context, "sphere", vertices[i]);
    assert_true(starg_mesh_vertex_count(meshes[1]) < 25000);
    assert_true(starg_mesh_vertex_count(meshes[2]) >= 25000);
    expect_level(context, meshes, (const size_t[]){0}, 1, 0);
    expect_level(context, meshes, (const size_t[]){0, 1}, 2, 1);
    expect_level(context, meshes, (const size_t[]){0, 1, 2, 3}, 4, 2);
    expect_level(context, meshes, (const size_t[]){2, 3}, 2, 0);
    for (size_t i = 0; i < MESHES; i++)
        starg_mesh_free(meshes[i]);
    test_context_free(context);
}

/* A level of an embedded model is taken for embedded without a check; that of another one is
 * checked. */
static void test_embedding(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *sphere = test_sample_mesh(context, "sphere", 500);
    shape box = shape_cube(1), crossing = shape_cube(1);
    shape_append(&crossing, &box, (const double[3]){0.5, 0.5, 0.5}, 0);
    starg_mesh *boxes = test_mesh_of(context, &crossing);
    starg_mesh *const models[] = {sphere, boxes};
    for (int i = 0; i < 2; i++) {
        starg_level entry = {.mesh = models[1 - i]};
        const starg_levels levels = {.count = 1, .levels = &entry};
        starg_solid *model = NULL, *proxy = NULL;
        test_ok(context, starg_solid_create(context, models[i], &model));
        test_ok(context, proxy_of_levels(context, model, &levels, &proxy));
        assert_int_equal(starg_solid_check(model)->embedded, i == 0);
        assert_true(starg_solid_check(proxy)->embedded);
        starg_solid_free(proxy);
        starg_solid_free(model);
    }
    shape_free(&box);
    shape_free(&crossing);
    starg_mesh_free(boxes);
    starg_mesh_free(sphere);
    test_context_free(context);
}

static void test_default_step(void **state) {
    (void)state;
    assert_int_equal(starg_guard_default_step(3000, 5000), 10000);
    assert_int_equal(starg_guard_default_step(45000, 5000), 10000);
    assert_true(starg_guard_default_step(45001, 5000) == STARG_QUARTERS);
    assert_true(starg_guard_default_step(1005000, 5000) == STARG_QUARTERS);
    assert_int_equal(starg_guard_default_step(1005000, 1000000), 10000);
    assert_int_equal(starg_guard_default_step(SIZE_MAX, SIZE_MAX), 10000);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_choice),
                                       cmocka_unit_test(test_embedding),
                                       cmocka_unit_test(test_default_step)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
