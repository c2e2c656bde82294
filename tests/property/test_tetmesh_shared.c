/* SPDX-License-Identifier: Apache-2.0 */
/* Every tetrahedral file of the shared data, with the counts of its README. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "starguard/check.h"
#include "starguard/tetra.h"

static const struct {
    const char *file;
    size_t tetrahedra, vertices, turned, surface_vertices, surface_faces;
} FILES[] = {
    {"av_bird.mesh", 20203, 5650, 0, 4331, 8658},
    {"av_bone.mesh", 6236, 1872, 0, 1513, 3022},
    {"av_duck.mesh", 12601, 2464, 0, 901, 1798},
    {"av_kitten.mesh", 54660, 14262, 0, 10183, 20366},
    {"bunny.mesh", 34055, 5433, 0, 337, 670},
    {"decimated-knight.mesh", 5452, 1822, 0, 1774, 3544},
    {"galaxy_rockerarm291.vtk", 8682, 2328, 8682, 1311, 2618},
    {"hand.mesh", 29998, 7234, 0, 4780, 9556},
    {"octopus-low.mesh", 1140, 452, 0, 451, 898},
    {"sdb_object.vtk", 11369, 2683, 11369, 1177, 2350},
    {"sdm_open.vtk", 2474, 850, 0, 778, 1552},
    {"sdm_thumb.vtk", 2727, 878, 0, 778, 1552},
};

static void test_files(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof FILES / sizeof *FILES; i++) {
        char path[4300];
        starg_tetmesh *mesh = NULL;
        starg_mesh *surface = NULL;
        starg_check *check = NULL;
        snprintf(path, sizeof path, "%s/tet/%s", data, FILES[i].file);
        test_ok(context, starg_tetmesh_read(context, path, &mesh));
        assert_int_equal(starg_tetmesh_count(mesh), FILES[i].tetrahedra);
        assert_int_equal(starg_tetmesh_vertex_count(mesh), FILES[i].vertices);
        if (FILES[i].turned > 0)
            assert_int_equal(starg_tetmesh_turned(mesh), FILES[i].turned);
        test_ok(context, starg_tetmesh_surface(context, mesh, &surface, NULL));
        assert_int_equal(starg_mesh_vertex_count(surface), FILES[i].surface_vertices);
        assert_int_equal(starg_mesh_face_count(surface), FILES[i].surface_faces);
        test_ok(context, starg_mesh_check(context, surface, &check));
        assert_true(check->usable);
        assert_int_equal(check->findings[STARG_FINDING_INWARD_COMPONENT].count, 0);
        double volume = starg_tetmesh_volume(mesh);
        assert_true(fabs(volume - starg_mesh_volume(surface)) < 1e-9 * volume);
        starg_check_free(context, check);
        starg_mesh_free(surface);
        starg_tetmesh_free(mesh);
    }
    test_context_free(context);
}

static void test_folded(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    starg_context *context = test_context(1);
    char path[4300];
    starg_tetmesh *mesh = NULL;
    snprintf(path, sizeof path, "%s/tet/av_dog_folded.mesh", data);
    assert_int_equal(starg_tetmesh_read(context, path, &mesh), STARG_ERROR_MESH);
    const starg_error *error = starg_context_error(context);
    assert_int_equal(error->element, STARG_ELEMENT_TETRAHEDRON);
    assert_in_range(error->index_count, 1, STARG_ERROR_INDICES);
    print_message("%s\n", error->message);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_files), cmocka_unit_test(test_folded)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
