/* SPDX-License-Identifier: Apache-2.0 */
/* Memory failures at every place in calls about surfaces: reading and writing, check, repair,
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

/* A separate context with the same memory. */
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

#define MESH(NAME, VARIANT, ...)                                                                   \
    FAILING_MAKES(NAME, VARIANT, starg_mesh, starg_mesh_free(out), __VA_ARGS__)
#define READ_TEXT(NAME, VARIANT, TEXT) MESH(NAME, VARIANT, TEXT, strlen(TEXT), "text." VARIANT)
#define WRITE(NAME, VARIANT, FORMAT)                                                               \
    FAILING(NAME, VARIANT, in.cube, failing_output("m." VARIANT), in_format(STARG_MESH_##FORMAT))

static const starg_mesh_write_options *in_format(starg_mesh_format format) {
    static starg_mesh_write_options options;
    starg_mesh_write_options_default(&options);
    options.format = format;
    return &options;
}

/* A polygon that a fan does not triangulate. */
static const char polygon[] =
    "OFF\n6 1 0\n0 0 0\n4 0 0\n4 4 0\n3 1 0\n2 4 0\n0 4 0\n6 0 1 2 3 4 5\n";
static const char ply[] =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
static const char stl[] = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                          "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n";

static const char colored[] = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";

static const char textured[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

static const char vtp[] =
    "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData>"
    "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">"
    "<Points><DataArray type=\"UInt8\" Name=\"p\" "
    "format=\"binary\">AQAAAEAAAAAJAAAADgAAAA==eJxjYGBgZABhAAARAAM=</DataArray></Points>"
    "<Polys><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2</DataArray>"
    "<DataArray type=\"Int32\" Name=\"offsets\">3</DataArray></Polys></Piece></PolyData></VTKFile>";

static starg_status dress_mesh(starg_context *context) {
    static const uint8_t colors[3 * 8] = {255, 0, 7};
    static const float texture[6 * 12] = {0.5F};
    starg_mesh *mesh;
    starg_status status =
        starg_mesh_create(context, starg_mesh_vertices(in.cube), 8, starg_mesh_faces(in.cube),
                          starg_mesh_face_count(in.cube), &mesh);
    if (status == STARG_OK)
        status = starg_mesh_set_colors(mesh, colors);
    if (status == STARG_OK)
        status = starg_mesh_set_texture(mesh, texture);
    starg_mesh_free(mesh);
    return status;
}

static starg_status meshes(starg_context *context) {
    FAILING_BY(starg_context_create, "", context_create(context));
    MESH(starg_mesh_create, "", starg_mesh_vertices(in.cube), starg_mesh_vertex_count(in.cube),
         starg_mesh_faces(in.cube), starg_mesh_face_count(in.cube));
    FAILING_BY(starg_mesh_set_colors, "", dress_mesh(context));
    FAILING_BY(starg_mesh_set_texture, "", dress_mesh(context));
    MESH(starg_mesh_read, "off", failing_input("room.off"));
    MESH(starg_mesh_read, "obj", failing_input("room.obj"));
    MESH(starg_mesh_read, "binary ply", failing_input("room.ply"));
    MESH(starg_mesh_read, "binary stl", failing_input("room.stl"));
    READ_TEXT(starg_mesh_read_memory, "polygon", polygon);
    READ_TEXT(starg_mesh_read_memory, "colours", colored);
    READ_TEXT(starg_mesh_read_memory, "texture", textured);
    READ_TEXT(starg_mesh_read_memory, "ply", ply);
    READ_TEXT(starg_mesh_read_memory, "stl", stl);
    READ_TEXT(starg_mesh_read_memory, "vtp", vtp);
    WRITE(starg_mesh_write, "off", OFF);
    WRITE(starg_mesh_write, "obj", OBJ);
    WRITE(starg_mesh_write, "ply", PLY_BINARY);
    WRITE(starg_mesh_write, "stl", STL_BINARY);
    WRITE(starg_mesh_write, "vtp", VTP);
    return STARG_OK;
}

/* ---- results from meshes ---- */

static starg_status repair(starg_context *context, const starg_mesh *mesh, bool unite) {
    starg_repair_report report;
    starg_repair_options options;
    starg_mesh *repaired = NULL;
    starg_repair_options_default(&options);
    options.unite = unite;
    starg_status status = starg_mesh_repair(context, mesh, &options, &repaired, &report);
    failing_result(status, repaired);
    starg_mesh_free(repaired);
    return status;
}

#define CHECK(NAME, VARIANT, MODEL)                                                                \
    FAILING_MAKES(NAME, VARIANT, starg_check, starg_check_free(context, out), MODEL)

static starg_status made_of_meshes(starg_context *context) {
    uint32_t map[64];
    starg_kernel_result kernel;
    starg_sample_options options;
    starg_sample_options_default(&options);
    options.vertex_count = 500;
    assert_true(starg_mesh_vertex_count(in.blob) <= 64);
    CHECK(starg_mesh_check, "", in.room);
    CHECK(starg_mesh_check, "self-intersecting", in.crossed);
    FAILING_BY(starg_mesh_repair, "nothing to do", repair(context, in.cube, false));
    FAILING_BY(starg_mesh_repair, "open", repair(context, in.open, false));
    FAILING_BY(starg_mesh_repair, "self-intersecting", repair(context, in.crossed, false));
    FAILING_BY(starg_mesh_repair, "union", repair(context, in.crossed, true));
    MESH(starg_mesh_simplify, "", in.blob, 6, NULL, map);
    FAILING_MAKES(starg_mesh_levels, "", starg_levels, starg_levels_free(context, out), in.blob, 5,
                  4, NULL);
    FAILING_MAKES(starg_solid_create, "", starg_solid, starg_solid_free(out), in.room);
    FAILING(starg_kernel, "star-shaped", in.cube, NULL, &kernel);
    FAILING(starg_kernel, "not", in.crossed, NULL, &kernel);
    MESH(starg_sample_create, "l-room", "l-room", &options);
    MESH(starg_sample_create, "torus", "torus", &options);
    MESH(starg_sample_create, "cat", "cat", &options);
    return STARG_OK;
}

/* ---- pictures and pages ---- */

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

static starg_status picture_encode(starg_context *context, const starg_picture_options *options) {
    uint8_t *png = NULL;
    size_t size = 0;
    starg_status status = starg_picture_encode(context, in.room, options, &png, &size);
    failing_result(status, png);
    starg_picture_bytes_free(context, png);
    return status;
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

#define SCENE(NAME, VARIANT)                                                                       \
    FAILING(NAME, VARIANT, &scene, failing_output("s." VARIANT), STARG_SCENE_AUTO)

static starg_status looked_at(starg_context *context) {
    static const double values[] = {0, 2, 2, 0}, x[] = {0, 1}, y[] = {1, 0};
    static const starg_curve curve = {.name = "c", .x = x, .y = y, .count = 2};
    const starg_mesh *const both[] = {in.cube, in.box};
    const double *const frames[] = {starg_mesh_vertices(in.cube), starg_mesh_vertices(in.box)};
    const starg_picture_options picture = small_picture();
    const starg_scene scene = {.model = in.room,
                               .guards = in.guards,
                               .seen = in.seen,
                               .pieces = in.pieces,
                               .report = in.report,
                               .skeleton = in.skeleton};
    FAILING(starg_animation_write, "", in.cube, frames, 2, 1, failing_output("a.glb"));
    FAILING_BY(starg_animation_read, "", animation_read(context));
    FAILING_BY(starg_animation_read_memory, "", animation_read_memory(context));
    FAILING(starg_picture_write, "", in.room, &picture, failing_output("p.png"));
    FAILING_BY(starg_picture_encode, "", picture_encode(context, &picture));
    FAILING(starg_picture_sheet_write, "", both, 1, 2, &picture, failing_output("s.png"));
    FAILING(starg_matrix_picture_write, "", values, 2, NULL, failing_output("m.png"));
    FAILING(starg_chart_write, "", &curve, 1, "x", "y", failing_output("c.svg"));
    SCENE(starg_scene_write, "glb");
    SCENE(starg_scene_write, "vtu");
    SCENE(starg_scene_write, "ply");
    SCENE(starg_scene_write, "obj");
    return STARG_OK;
}

static starg_status pages(starg_context *context) {
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
    FAILING(starg_page_write, "", &page, failing_output("p.html"));
    return STARG_OK;
}

FAILING_TEST(meshes)
FAILING_TEST(made_of_meshes)
FAILING_TEST(looked_at)

static void test_pages(void **state) {
    (void)state;
    if (!starg_page_available()) {
        printf("skipped: this build has no viewer\n");
        skip();
    }
    failing_run(pages);
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
