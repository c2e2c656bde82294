/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes in one file: their contents, read back by our mesh readers and by code here; inconsistent
 * input, and every way in which writing can fail. tests/cli/test_export.py opens the files with
 * other programs' readers. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "models.h"
#include "starguard/check.h"
#include "starguard/decompose.h"
#include "starguard/scene.h"

enum { BALL = 72 }; /* faces of a guard's symbol */

static const char *const NAMES[] = {"scene.glb", "scene.vtu", "scene.ply", "scene.obj"};
enum { FORMATS = 4 };

static char folder[64], path[128];

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/test_scene_XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int remove_folder(void **state) {
    (void)state;
    return rmdir(folder); /* fails if a test has left anything */
}

static const char *in_folder(const char *name) {
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* ---- a scene with everything ---- */

typedef struct stage {
    starg_context *context;
    starg_solid *solid;
    starg_guards *guards;
    starg_bits *seen;
    starg_decomposition *pieces;
    starg_pieces_mesh mesh;
    starg_pieces_report report;
    starg_skeleton *skeleton;
    starg_scene scene;
} stage;

static stage make_stage(void) {
    stage s = {.context = test_context(1)};
    shape room = shape_room();
    s.solid = test_solid_of(s.context, &room);
    shape_free(&room);
    starg_decompose_options wanted;
    starg_decompose_options_default(&wanted);
    wanted.effort = 5;
    test_ok(s.context, starg_guard(s.context, s.solid, NULL, &s.guards));
    test_ok(s.context, starg_visibility(s.context, s.solid, s.guards->positions, s.guards->count,
                                        NULL, &s.seen));
    test_ok(s.context, starg_decompose(s.context, s.solid, &wanted, &s.pieces));
    test_ok(s.context, starg_skeleton_create(s.context, s.solid, NULL, &s.skeleton));
    const starg_tetmesh *tets = s.pieces->mesh;
    s.mesh = (starg_pieces_mesh){.vertex_count = starg_tetmesh_vertex_count(tets),
                                 .count = starg_tetmesh_count(tets),
                                 .labels = s.pieces->labels};
    memcpy(&s.mesh.vertices, &(const double *){starg_tetmesh_vertices(tets)}, sizeof(double *));
    memcpy(&s.mesh.tetrahedra, &(const uint32_t *){starg_tetmesh_tetrahedra(tets)},
           sizeof(uint32_t *));
    s.report = (starg_pieces_report){.piece_count = s.pieces->piece_count,
                                     .pieces = s.pieces->pieces,
                                     .tetrahedra = s.mesh.count};
    s.scene = (starg_scene){.model = starg_solid_mesh(s.solid),
                            .guards = s.guards,
                            .seen = s.seen,
                            .skeleton = s.skeleton};
    return s;
}

/* The structs that the scene points to are in the stage, at its current address. */
static starg_scene whole_scene(const stage *s) {
    starg_scene scene = s->scene;
    scene.pieces = &s->mesh;
    scene.report = &s->report;
    return scene;
}

static void free_stage(stage *s) {
    starg_skeleton_free(s->context, s->skeleton);
    starg_decomposition_free(s->context, s->pieces);
    starg_bits_free(s->seen);
    starg_guards_free(s->context, s->guards);
    starg_solid_free(s->solid);
    test_context_free(s->context);
}

/* The volume of a written mesh, all of whose faces must pair up. */
static double closed_volume(starg_context *context, size_t *faces) {
    starg_mesh *mesh = NULL;
    starg_check *check = NULL;
    test_ok(context, starg_mesh_read(context, path, &mesh));
    test_ok(context, starg_mesh_check(context, mesh, &check));
    assert_true(check->closed && check->manifold && check->oriented);
    double volume = starg_mesh_volume(mesh);
    *faces = starg_mesh_face_count(mesh);
    starg_check_free(context, check);
    starg_mesh_free(mesh);
    return volume;
}

static void test_balls_are_closed_and_outward(void **state) {
    (void)state;
    stage s = make_stage();
    const starg_scene scene = {.model = s.scene.model, .guards = s.guards};
    size_t faces;
    test_ok(s.context, starg_scene_write(s.context, &scene, in_folder("scene.ply"), 0));
    double volume = closed_volume(s.context, &faces);
    assert_int_equal(faces, starg_mesh_face_count(s.scene.model) + BALL * s.guards->count);
    double lower[3], upper[3], size = 0, room = starg_mesh_volume(s.scene.model);
    starg_mesh_bounds(s.scene.model, lower, upper);
    for (int k = 0; k < 3; k++)
        size = fmax(size, upper[k] - lower[k]);
    /* the ball is inscribed in a sphere */
    double ball = 4.18879020478639 * pow(0.015 * size, 3);
    assert_true(volume > room && volume < room + ball * (double)s.guards->count);
    unlink(path);
    free_stage(&s);
}

static void test_pieces_make_up_the_model(void **state) {
    (void)state;
    stage s = make_stage();
    const starg_scene scene = {.model = s.scene.model, .pieces = &s.mesh, .report = &s.report};
    const char *const names[] = {"scene.ply", "scene.obj"};
    for (int i = 0; i < 2; i++) {
        starg_mesh *mesh = NULL;
        test_ok(s.context, starg_scene_write(s.context, &scene, in_folder(names[i]), 0));
        test_ok(s.context, starg_mesh_read(s.context, path, &mesh));
        double wanted = starg_mesh_volume(s.scene.model);
        assert_true(fabs(starg_mesh_volume(mesh) - wanted) < 1e-9 * wanted);
        starg_mesh_free(mesh);
        unlink(path);
    }
    free_stage(&s);
}

/* ---- missing or inconsistent parts ---- */

static void test_every_part_may_be_alone(void **state) {
    (void)state;
    stage s = make_stage();
    const starg_scene alone[] = {{.model = s.scene.model},
                                 {.guards = s.guards},
                                 {.pieces = &s.mesh},
                                 {.skeleton = s.skeleton},
                                 {.model = s.scene.model, .skeleton = s.skeleton}};
    for (size_t i = 0; i < sizeof alone / sizeof *alone; i++)
        for (int f = 0; f < FORMATS; f++) {
            struct stat info;
            test_ok(s.context, starg_scene_write(s.context, &alone[i], in_folder(NAMES[f]), 0));
            assert_int_equal(stat(path, &info), 0);
            assert_true(info.st_size > 0);
            unlink(path);
        }
    free_stage(&s);
}

static void refuse(stage *s, const starg_scene *scene, const char *name, starg_scene_format format,
                   const char *says) {
    assert_int_equal(starg_scene_write(s->context, scene, in_folder(name), format),
                     STARG_ERROR_ARGUMENT);
    if (strstr(starg_context_error(s->context)->message, says) == NULL)
        fail_msg("'%s' says nothing of '%s'", starg_context_error(s->context)->message, says);
    assert_int_not_equal(access(path, F_OK), 0);
}

static void test_what_does_not_fit(void **state) {
    (void)state;
    stage s = make_stage();
    starg_scene scene = whole_scene(&s);
    refuse(&s, &scene, "scene.stl", STARG_SCENE_AUTO, ".glb, .vtu, .ply, .obj or .3mf");
    refuse(&s, &scene, "scene", STARG_SCENE_AUTO, ".glb, .vtu, .ply, .obj or .3mf");
    refuse(&s, &scene, "scene.glb", (starg_scene_format)77, "77");
    refuse(&s, &(starg_scene){0}, "scene.glb", 0, "nothing to write");

    shape cube = shape_cube(1);
    starg_mesh *other = test_mesh_of(s.context, &cube);
    shape_free(&cube);
    scene.model = other;
    refuse(&s, &scene, "scene.glb", 0, "give the right model");
    starg_mesh_free(other);
    scene = (starg_scene){.model = s.scene.model, .seen = s.seen};
    refuse(&s, &scene, "scene.glb", 0, "one row per guard");
    scene = (starg_scene){.model = s.scene.model, .report = &s.report};
    refuse(&s, &scene, "scene.glb", 0, "needs its tetrahedra");
    starg_pieces_report fewer = s.report;
    fewer.piece_count++;
    scene = (starg_scene){.pieces = &s.mesh, .report = &fewer};
    refuse(&s, &scene, "scene.glb", 0, "the same decomposition");
    uint32_t ends[2] = {0, 2};
    double nodes[6] = {0};
    starg_skeleton bad = {.node_count = 2, .edge_count = 1, .positions = nodes, .edges = ends};
    scene = (starg_scene){.skeleton = &bad};
    refuse(&s, &scene, "scene.vtu", 0, "names node 2");
    free_stage(&s);
}

static void test_coordinates_beyond_single_precision(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(1);
    shape_place(&cube, 1e60, 0);
    starg_mesh *mesh = test_mesh_of(context, &cube);
    shape_free(&cube);
    const starg_scene scene = {.model = mesh};
    for (int f = 0; f < FORMATS; f++) {
        starg_status status = starg_scene_write(context, &scene, in_folder(NAMES[f]), 0);
        assert_int_equal(status, f == 0 ? STARG_ERROR_RANGE : STARG_OK);
        assert_int_equal(unlink(path), f == 0 ? -1 : 0);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* A skeleton that is one point has no edges. */
static void test_a_single_node(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double node[3] = {1, 2, 3};
    starg_skeleton skeleton = {.node_count = 1, .positions = node};
    const starg_scene scene = {.skeleton = &skeleton};
    for (int f = 0; f < FORMATS; f++) {
        test_ok(context, starg_scene_write(context, &scene, in_folder(NAMES[f]), 0));
        assert_int_equal(unlink(path), 0);
    }
    test_context_free(context);
}

/* ---- failures while writing ---- */

static void test_unwritable(void **state) {
    (void)state;
    stage s = make_stage();
    for (int f = 0; f < FORMATS; f++) {
        char name[64];
        snprintf(name, sizeof name, "none/%s", NAMES[f]);
        assert_int_equal(starg_scene_write(s.context, &s.scene, in_folder(name), 0),
                         STARG_ERROR_WRITE);
    }
    starg_context_cancel(s.context);
    assert_int_equal(starg_scene_write(s.context, &s.scene, in_folder("scene.glb"), 0),
                     STARG_ERROR_CANCELLED);
    free_stage(&s);
}

/* Every allocation fails once: an error, no leak, no file. */
static void test_scarce_memory(void **state) {
    (void)state;
    stage s = make_stage();
    const starg_scene scene = whole_scene(&s);
    for (int f = 0; f < FORMATS; f++) {
        starg_status status = STARG_ERROR_MEMORY;
        for (size_t blocks = 1; status != STARG_OK; blocks++) {
            size_t left = blocks;
            starg_context *context = test_scarce_context(1, &left);
            status = starg_scene_write(context, &scene, in_folder(NAMES[f]), 0);
            assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
            assert_int_equal(access(path, F_OK) == 0, status == STARG_OK);
            assert_true(blocks < 100);
            test_context_free(context);
        }
        assert_int_equal(unlink(path), 0);
    }
    free_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_balls_are_closed_and_outward),
        cmocka_unit_test(test_pieces_make_up_the_model),
        cmocka_unit_test(test_every_part_may_be_alone),
        cmocka_unit_test(test_what_does_not_fit),
        cmocka_unit_test(test_coordinates_beyond_single_precision),
        cmocka_unit_test(test_a_single_node),
        cmocka_unit_test(test_unwritable),
        cmocka_unit_test(test_scarce_memory),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
