/* SPDX-License-Identifier: Apache-2.0 */
/* Real models of up to 600 vertices, with STARGUARD_LONG 1,200: guarded, verified, and the same
 * with every engine. */
#include "support.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"
#include "starguard/guard.h"

static void check_model(starg_context *context, const char *name, const starg_mesh *mesh) {
    starg_solid *solid = NULL;
    starg_guards *best = NULL, *other = NULL;
    starg_guard_options options;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_guard_options_default(&options);
    options.candidate_count = 200;
    options.method = STARG_GUARD_ILP;
    test_ok(context, starg_guard(context, solid, &options, &best));
    test_verified(context, name, mesh, best);
    assert_true(best->lower_bound <= best->count);
    /* every face with area of an embedded boundary can be seen */
    if (starg_solid_check(solid)->embedded)
        assert_int_equal(best->uncovered_count, 0);

    options.method = STARG_GUARD_GREEDY;
    for (int engine = 0; engine <= STARG_VISIBILITY_FASTEST; engine++) {
        options.visibility.engine = (starg_visibility_engine)engine;
        starg_guards *greedy = NULL;
        test_ok(context, starg_guard(context, solid, &options, &greedy));
        assert_true(greedy->count >= best->count || !best->optimal);
        assert_true(greedy->lower_bound <= best->count);
        if (other != NULL) {
            assert_int_equal(greedy->count, other->count);
            assert_memory_equal(greedy->positions, other->positions, 24 * other->count);
        }
        starg_guards_free(context, other);
        other = greedy;
    }
    starg_guards_free(context, other);
    starg_guards_free(context, best);
    starg_solid_free(solid);
}

static void check_folder(const char *folder, size_t *checked) {
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    char path[4400];
    snprintf(path, sizeof path, "%s/%s", data, folder);
    DIR *files = opendir(path);
    assert_non_null(files);
    starg_context *context = test_context(2);
    for (struct dirent *file = readdir(files); file != NULL; file = readdir(files)) {
        starg_mesh *mesh = NULL;
        if (strstr(file->d_name, ".off") == NULL)
            continue;
        snprintf(path, sizeof path, "%s/%s/%s", data, folder, file->d_name);
        test_ok(context, starg_mesh_read(context, path, &mesh));
        if (starg_mesh_vertex_count(mesh) <= test_size(350, 1200)) {
            check_model(context, file->d_name, mesh);
            ++*checked;
        }
        starg_mesh_free(mesh);
    }
    closedir(files);
    test_context_free(context);
}

/* If a surface intersects itself, refinement finds points that see what no earlier candidate saw:
 * then the earlier number of guards is not enough. */
static void test_refined_crossing(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    char path[4400];
    starg_context *context = test_context(2);
    starg_mesh *mesh = NULL;
    starg_solid *solid = NULL;
    starg_guards *guards = NULL;
    starg_guard_options options;
    snprintf(path, sizeof path, "%s/poses/cat_08.off", data);
    test_ok(context, starg_mesh_read(context, path, &mesh));
    test_ok(context, starg_solid_create(context, mesh, &solid));
    starg_guard_options_default(&options);
    options.candidates = STARG_CANDIDATES_INTERIOR;
    options.refine_lines = test_size(250000, 1000000);
    test_ok(context, starg_guard(context, solid, &options, &guards));
    test_verified(context, "cat_08, refined", mesh, guards);
    assert_int_equal(guards->coverable_faces + guards->uncovered_count, guards->face_count);
    starg_guards_free(context, guards);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void test_cad(void **state) {
    size_t checked = 0;
    (void)state;
    check_folder("cad", &checked);
    assert_true(checked >= test_size(15, 25));
}

static void test_small_solids(void **state) {
    size_t checked = 0;
    (void)state;
    check_folder("table2", &checked);
    check_folder("solids", &checked);
    assert_true(checked >= test_size(1, 6));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_refined_crossing),
                                       cmocka_unit_test(test_cad),
                                       cmocka_unit_test(test_small_solids)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
