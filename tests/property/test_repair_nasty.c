/* SPDX-License-Identifier: Apache-2.0 */
/* Repair of every readable nasty file: a usable solid or a clear message, and required results for
 * some of them. */
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "models.h"
#include "starguard/check.h"
#include "starguard/repair.h"
#include "support.h"

/* Larger ones only with STARGUARD_ALL_TABLES=1. */
enum { MOST_FACES = 10000 };

/* Upper limits on what is left after repair. */
typedef struct expectation {
    const char *file;
    bool fails, unchanged;
    long crossings;
} expectation;

static const expectation EXPECTATIONS[] = {
    {"Cray_right.obj", false, true, 0},
    {"blobby-shuffled.off", false, false, 0},
    {"camel_gallop_01.off", false, false, 0},
    {"comments.off", false, true, 0},
    {"cow_nonmanifold_vertex.obj", false, false, 0},
    {"cube-ouvert.off", false, false, 0},
    {"degtri_sliding.off", true, false, 0},
    {"elephant-with-holes.off", false, false, 0},
    {"fan3.obj", false, false, 0},
    {"head.off", false, false, 0},
    {"hourglass_ico.obj", false, false, 0},
    {"hull-body.obj", false, true, 0},
    {"moebius.obj", true, false, 0},
    {"multibody.stl", false, false, 0},
    {"shared_edge.STL", false, false, 0},
    {"sliver_tet.ply", false, false, 0},
    {"snake_loop.off", false, false, 0},
    {"soup.stl", true, false, 0},
    {"tetra_intersected_by_triangle.off", false, false, 0},
    {"two_cubes_1.obj", false, true, -1},
    {"whitespace.off", false, true, 0},
};

static const expectation *expectation_for(const char *file) {
    static const expectation any = {"", false, false, -1};
    for (size_t i = 0; i < sizeof EXPECTATIONS / sizeof *EXPECTATIONS; i++)
        if (strcmp(EXPECTATIONS[i].file, file) == 0)
            return &EXPECTATIONS[i];
    return &any;
}

static void expect_solid(starg_context *context, const char *file, const starg_mesh *input,
                         const starg_mesh *mesh, const starg_repair_report *report) {
    const expectation *e = expectation_for(file);
    starg_solid *solid = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    const starg_check *check = starg_solid_check(solid);
    const starg_finding *crossing = &check->findings[STARG_FINDING_SELF_INTERSECTION];
    if (e->fails || (e->unchanged && !test_same_mesh(input, mesh)))
        fail_msg("%s: came back %s", file, e->fails ? "as a solid" : "changed");
    if (crossing->count != report->intersections_after ||
        (e->crossings >= 0 && crossing->count > (size_t)e->crossings))
        fail_msg("%s: %zu crossing pairs are left", file, crossing->count);
    if (check->findings[STARG_FINDING_INWARD_COMPONENT].count > report->sheets_kept ||
        check->findings[STARG_FINDING_ISOLATED_VERTEX].count > 0)
        fail_msg("%s: inward shells or isolated vertices are left", file);
    starg_solid_free(solid);
}

static void repair_file(starg_context *context, const char *file, const starg_mesh *input) {
    starg_mesh *mesh = NULL;
    starg_repair_report report;
    starg_status status = starg_mesh_repair(context, input, NULL, &mesh, &report);
    if (status == STARG_OK) {
        expect_solid(context, file, input, mesh, &report);
    } else {
        assert_int_equal(status, STARG_ERROR_MESH);
        assert_null(mesh);
        assert_true(strlen(starg_context_error(context)->message) > 20);
        if (!expectation_for(file)->fails)
            fail_msg("%s: %s", file, starg_context_error(context)->message);
    }
    starg_mesh_free(mesh);
}

static void every_nasty_file(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    char folder[4400], path[5000];
    snprintf(folder, sizeof folder, "%s/nasty", data);
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    starg_context *context = test_context(1);
    bool all = getenv("STARGUARD_ALL_TABLES") != NULL;
    size_t repaired = 0;
    for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
        starg_mesh *mesh = NULL;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] == '.' || starg_mesh_read(context, path, &mesh) != STARG_OK)
            continue;
        if (all || starg_mesh_face_count(mesh) <= MOST_FACES) {
            repair_file(context, entry->d_name, mesh);
            repaired++;
        }
        starg_mesh_free(mesh);
    }
    closedir(directory);
    test_context_free(context);
    assert_true(repaired >= 35);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_nasty_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
