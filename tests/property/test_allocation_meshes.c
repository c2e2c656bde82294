/* Memory that fails at every place of the calls about surfaces: reading and writing, check, repair,
 * levels, solids, kernels, samples, pictures, animations, pages and scenes. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/context.h"
#include "starguard/animation.h"
#include "starguard/check.h"
#include "starguard/kernel.h"
#include "starguard/page.h"
#include "starguard/picture.h"
#include "starguard/repair.h"
#include "starguard/sample.h"
#include "starguard/scene.h"
#include "starguard/simplify.h"

static failing_inputs in;
static input_bytes animation;

/* ---- contexts ---- */

/* A context of its own, with the same memory. */
static starg_status context_create(starg_context *context) {
    starg_context_options options;
    starg_context *made = NULL;
    starg_context_options_default(&options);
    options.allocator = context->allocator;
    starg_status status = starg_context_create(&options, &made);
    if (status != STARG_OK) /* there is no context yet to hold a message */
        starg_fail_memory(context, "context");
    failing_result(status, made);
    starg_context_free(made);
    return status;
}

/* ---- meshes ---- */

static starg_status mesh_result(starg_status status, starg_mesh *mesh) {
    failing_result(status, mesh);
    starg_mesh_free(mesh);
    return status;
}

static starg_status mesh_create(starg_context *context) {
    starg_mesh *mesh = NULL;
    starg_status status =
        starg_mesh_create(context, starg_mesh_vertices(in.cube), starg_mesh_vertex_count(in.cube),
                          starg_mesh_faces(in.cube), starg_mesh_face_count(in.cube), &mesh);
    return mesh_result(status, mesh);
}

static starg_status read_named(starg_context *context, const char *name) {
    starg_mesh *mesh = NULL;
    starg_status status = starg_mesh_read(context, failing_input(name), &mesh);
    return mesh_result(status, mesh);
}

static starg_status mesh_read_off(starg_context *context) {
    return read_named(context, "room.off");
}

static starg_status mesh_read_obj(starg_context *context) {
    return read_named(context, "room.obj");
}

static starg_status mesh_read_ply(starg_context *context) {
    return read_named(context, "room.ply");
}

static starg_status mesh_read_stl(starg_context *context) {
    return read_named(context, "room.stl");
}

static starg_status read_text(starg_context *context, const char *text, const char *name) {
    starg_mesh *mesh = NULL;
    starg_status status = starg_mesh_read_memory(context, text, strlen(text), name, &mesh);
    return mesh_result(status, mesh);
}

/* A polygon that the fan does not cut. */
static starg_status mesh_read_polygon(starg_context *context) {
    return read_text(context,
                     "OFF\n6 1 0\n0 0 0\n4 0 0\n4 4 0\n3 1 0\n2 4 0\n0 4 0\n6 0 1 2 3 4 5\n",
                     "polygon.off");
}

static starg_status mesh_read_ply_text(starg_context *context) {
    return read_text(context,
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                     "text.ply");
}

static starg_status mesh_read_stl_text(starg_context *context) {
    return read_text(context,
                     "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                     "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n",
                     "text.stl");
}

static starg_status write_named(starg_context *context, const char *name,
                                starg_mesh_format format) {
    starg_mesh_write_options options;
    starg_mesh_write_options_default(&options);
    options.format = format;
    return starg_mesh_write(context, in.cube, failing_output(name), &options);
}

static starg_status mesh_write_off(starg_context *context) {
    return write_named(context, "m.off", STARG_MESH_OFF);
}

static starg_status mesh_write_obj(starg_context *context) {
    return write_named(context, "m.obj", STARG_MESH_OBJ);
}

static starg_status mesh_write_ply(starg_context *context) {
    return write_named(context, "m.ply", STARG_MESH_PLY_BINARY);
}

static starg_status mesh_write_stl(starg_context *context) {
    return write_named(context, "m.stl", STARG_MESH_STL_BINARY);
}

/* ---- what is made of meshes ---- */

static starg_status check_of(starg_context *context, const starg_mesh *mesh) {
    starg_check *check = NULL;
    starg_status status = starg_mesh_check(context, mesh, &check);
    failing_result(status, check);
    starg_check_free(context, check);
    return status;
}

static starg_status mesh_check_fine(starg_context *context) {
    return check_of(context, in.room);
}

static starg_status mesh_check_crossed(starg_context *context) {
    return check_of(context, in.crossed);
}

static starg_status repair_of(starg_context *context, const starg_mesh *mesh) {
    starg_repair_report report;
    starg_mesh *repaired = NULL;
    starg_status status = starg_mesh_repair(context, mesh, NULL, &repaired, &report);
    return mesh_result(status, repaired);
}

static starg_status mesh_repair_open(starg_context *context) {
    return repair_of(context, in.open);
}

static starg_status mesh_repair_crossed(starg_context *context) {
    return repair_of(context, in.crossed);
}

static starg_status mesh_repair_fine(starg_context *context) {
    return repair_of(context, in.cube);
}

static starg_status mesh_simplify(starg_context *context) {
    uint32_t map[64];
    starg_mesh *coarse = NULL;
    assert_true(starg_mesh_vertex_count(in.blob) <= 64);
    starg_status status = starg_mesh_simplify(context, in.blob, 6, NULL, map, &coarse);
    return mesh_result(status, coarse);
}

static starg_status mesh_levels(starg_context *context) {
    starg_levels *levels = NULL;
    starg_status status = starg_mesh_levels(context, in.blob, 5, 4, NULL, &levels);
    failing_result(status, levels);
    starg_levels_free(context, levels);
    return status;
}

static starg_status solid_create(starg_context *context) {
    starg_solid *solid = NULL;
    starg_status status = starg_solid_create(context, in.room, &solid);
    failing_result(status, solid);
    starg_solid_free(solid);
    return status;
}

static starg_status kernel_of(starg_context *context, const starg_mesh *mesh) {
    starg_kernel_result result;
    return starg_kernel(context, mesh, NULL, &result);
}

static starg_status kernel_cube(starg_context *context) {
    return kernel_of(context, in.cube);
}

static starg_status kernel_crossed(starg_context *context) {
    return kernel_of(context, in.crossed);
}

static starg_status sample_of(starg_context *context, const char *name) {
    starg_sample_options options;
    starg_mesh *mesh = NULL;
    starg_sample_options_default(&options);
    options.vertex_count = 500;
    starg_status status = starg_sample_create(context, name, &options, &mesh);
    return mesh_result(status, mesh);
}

static starg_status sample_room(starg_context *context) {
    return sample_of(context, "l-room");
}

static starg_status sample_torus(starg_context *context) {
    return sample_of(context, "torus");
}

static starg_status sample_cat(starg_context *context) {
    return sample_of(context, "cat");
}

/* ---- what is looked at ---- */

static starg_status animation_write(starg_context *context) {
    const double *const frames[] = {starg_mesh_vertices(in.cube), starg_mesh_vertices(in.box)};
    return starg_animation_write(context, in.cube, frames, 2, 1, failing_output("a.glb"));
}

static starg_status frames_result(starg_context *context, starg_status status, starg_mesh **frames,
                                  size_t count) {
    assert_int_equal(count, status == STARG_OK ? 2 : 0);
    failing_result(status, frames);
    starg_animation_free(context, frames, count);
    return status;
}

static starg_status animation_read(starg_context *context) {
    starg_mesh **frames = NULL;
    size_t count = 0;
    starg_status status =
        starg_animation_read(context, failing_input("animation.glb"), &frames, &count);
    return frames_result(context, status, frames, count);
}

static starg_status animation_read_memory(starg_context *context) {
    starg_mesh **frames = NULL;
    size_t count = 0;
    starg_status status =
        starg_animation_read_memory(context, animation.data, animation.size, "a", &frames, &count);
    return frames_result(context, status, frames, count);
}

static starg_picture_options small_picture(void) {
    starg_picture_options options;
    starg_picture_options_default(&options);
    options.width = 20;
    options.height = 16;
    options.points = in.guards->positions;
    options.point_count = in.guards->count;
    return options;
}

static starg_status picture_write(starg_context *context) {
    const starg_picture_options options = small_picture();
    return starg_picture_write(context, in.room, &options, failing_output("p.png"));
}

static starg_status picture_encode(starg_context *context) {
    const starg_picture_options options = small_picture();
    uint8_t *png = NULL;
    size_t size = 0;
    starg_status status = starg_picture_encode(context, in.room, &options, &png, &size);
    failing_result(status, png);
    starg_picture_bytes_free(context, png);
    return status;
}

static starg_status picture_sheet_write(starg_context *context) {
    const starg_picture_options options = small_picture();
    const starg_mesh *const meshes[] = {in.cube, in.box};
    return starg_picture_sheet_write(context, meshes, 1, 2, &options, failing_output("s.png"));
}

static starg_status matrix_picture_write(starg_context *context) {
    static const double values[] = {0, 2, 2, 0};
    return starg_matrix_picture_write(context, values, 2, failing_output("m.png"));
}

static starg_status chart_write(starg_context *context) {
    static const double x[] = {0, 1}, y[] = {1, 0};
    static const starg_curve curve = {.name = "c", .x = x, .y = y, .count = 2};
    return starg_chart_write(context, &curve, 1, "x", "y", failing_output("c.svg"));
}

static starg_status page_write(starg_context *context) {
    const starg_mesh *const frames[] = {in.cube, in.box};
    const starg_page page = {.model = in.room,
                             .model_name = "room.off",
                             .guards = in.guards,
                             .seen = in.seen,
                             .pieces = in.pieces,
                             .report = in.report,
                             .skeleton = in.skeleton,
                             .frames = frames,
                             .frame_count = 2};
    return starg_page_write(context, &page, failing_output("p.html"));
}

static starg_status scene_of(starg_context *context, const char *name) {
    const starg_scene scene = {.model = in.room,
                               .guards = in.guards,
                               .seen = in.seen,
                               .pieces = in.pieces,
                               .report = in.report,
                               .skeleton = in.skeleton};
    return starg_scene_write(context, &scene, failing_output(name), STARG_SCENE_AUTO);
}

static starg_status scene_write_glb(starg_context *context) {
    return scene_of(context, "s.glb");
}

static starg_status scene_write_vtu(starg_context *context) {
    return scene_of(context, "s.vtu");
}

static starg_status scene_write_ply(starg_context *context) {
    return scene_of(context, "s.ply");
}

static starg_status scene_write_obj(starg_context *context) {
    return scene_of(context, "s.obj");
}

/* ---- the tables ---- */

static const failing_call meshes[] = {
    {"starg_context_create", "", context_create, NULL},
    {"starg_mesh_create", "", mesh_create, NULL},
    {"starg_mesh_read", "off", mesh_read_off, NULL},
    {"starg_mesh_read", "obj", mesh_read_obj, NULL},
    {"starg_mesh_read", "binary ply", mesh_read_ply, NULL},
    {"starg_mesh_read", "binary stl", mesh_read_stl, NULL},
    {"starg_mesh_read_memory", "polygon", mesh_read_polygon, NULL},
    {"starg_mesh_read_memory", "ply", mesh_read_ply_text, NULL},
    {"starg_mesh_read_memory", "stl", mesh_read_stl_text, NULL},
    {"starg_mesh_write", "off", mesh_write_off, NULL},
    {"starg_mesh_write", "obj", mesh_write_obj, NULL},
    {"starg_mesh_write", "ply", mesh_write_ply, NULL},
    {"starg_mesh_write", "stl", mesh_write_stl, NULL},
};

static const failing_call made_of_meshes[] = {
    {"starg_mesh_check", "", mesh_check_fine, NULL},
    {"starg_mesh_check", "self-intersecting", mesh_check_crossed, NULL},
    {"starg_mesh_repair", "nothing to do", mesh_repair_fine, NULL},
    {"starg_mesh_repair", "open", mesh_repair_open, NULL},
    {"starg_mesh_repair", "self-intersecting", mesh_repair_crossed, NULL},
    {"starg_mesh_simplify", "", mesh_simplify, NULL},
    {"starg_mesh_levels", "", mesh_levels, NULL},
    {"starg_solid_create", "", solid_create, NULL},
    {"starg_kernel", "star-shaped", kernel_cube, NULL},
    {"starg_kernel", "not", kernel_crossed, NULL},
    {"starg_sample_create", "l-room", sample_room, NULL},
    {"starg_sample_create", "torus", sample_torus, NULL},
    {"starg_sample_create", "cat", sample_cat, NULL},
};

static const failing_call looked_at[] = {
    {"starg_animation_write", "", animation_write, NULL},
    {"starg_animation_read", "", animation_read, NULL},
    {"starg_animation_read_memory", "", animation_read_memory, NULL},
    {"starg_picture_write", "", picture_write, NULL},
    {"starg_picture_encode", "", picture_encode, NULL},
    {"starg_picture_sheet_write", "", picture_sheet_write, NULL},
    {"starg_matrix_picture_write", "", matrix_picture_write, NULL},
    {"starg_chart_write", "", chart_write, NULL},
    {"starg_scene_write", "glb", scene_write_glb, NULL},
    {"starg_scene_write", "vtu", scene_write_vtu, NULL},
    {"starg_scene_write", "ply", scene_write_ply, NULL},
    {"starg_scene_write", "obj", scene_write_obj, NULL},
};

static const failing_call pages[] = {
    {"starg_page_write", "", page_write, NULL},
};

static void test_meshes(void **state) {
    (void)state;
    FAILING_RUN(meshes);
}

static void test_made_of_meshes(void **state) {
    (void)state;
    FAILING_RUN(made_of_meshes);
}

static void test_looked_at(void **state) {
    (void)state;
    FAILING_RUN(looked_at);
}

static void test_pages(void **state) {
    (void)state;
    if (!starg_page_available()) {
        printf("skipped: this build has no viewer\n");
        skip();
    }
    FAILING_RUN(pages);
}

static int set_up(void **state) {
    (void)state;
    failing_inputs_make(&in);
    const double *const frames[] = {starg_mesh_vertices(in.cube), starg_mesh_vertices(in.box)};
    test_ok(in.context, starg_animation_write(in.context, in.cube, frames, 2, 1,
                                              failing_input("animation.glb")));
    animation = failing_input_bytes("animation.glb");
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(animation.data);
    failing_inputs_free(&in);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_meshes),
        cmocka_unit_test(test_made_of_meshes),
        cmocka_unit_test(test_looked_at),
        cmocka_unit_test(test_pages),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
