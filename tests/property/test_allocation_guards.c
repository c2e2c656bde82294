/* SPDX-License-Identifier: Apache-2.0 */
/* Memory failures at every place in calls about guards: bits, covers, visibility, skeletons,
 * candidates, guards, and their verification. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdlib.h>

#include "starguard/cover.h"
#include "starguard/page.h"

static failing_inputs in;
static starg_bits *cover_rows;
static input_bytes guards_text, skeleton_text, why_text;
static starg_guards *proven;
static starg_certificate *why;

/* ---- covers and visibility ---- */

static const starg_cover_options *by(starg_cover_method method) {
    static starg_cover_options options;
    starg_cover_options_default(&options);
    options.method = method;
    options.max_nodes = 20;
    options.prices = true;
    return &options;
}

#define COVER(NAME, VARIANT, METHOD, PROBLEM)                                                      \
    FAILING_MAKES(NAME, VARIANT, starg_cover, starg_cover_free(out), PROBLEM,                      \
                  by(STARG_COVER_##METHOD))

static starg_status covers(starg_context *context) {
    static const uint32_t given[] = {1};
    starg_cover_problem whole;
    starg_cover_problem_default(&whole);
    whole.rows = cover_rows;
    starg_cover_problem redundant = whole, partial = whole, limited = whole;
    redundant.redundancy = 2;
    redundant.given = given;
    redundant.given_count = 1;
    partial.target = 9;
    limited.max_rows = 3;
    FAILING_MAKES(starg_bits_create, "", starg_bits, starg_bits_free(out), 3, 70);
    COVER(starg_cover_solve, "greedy", GREEDY, &whole);
    COVER(starg_cover_solve, "ilp", ILP, &whole);
    COVER(starg_cover_solve, "lp", LP, &whole);
    COVER(starg_cover_solve, "redundant, given rows", ILP, &redundant);
    COVER(starg_cover_solve, "a part of the weight", ILP, &partial);
    COVER(starg_cover_solve, "at most 3 rows", ILP, &limited);
    return STARG_OK;
}

static const starg_visibility_options *look(starg_visibility_engine engine, starg_target target,
                                            starg_face_rule rule) {
    static starg_visibility_options options;
    starg_visibility_options_default(&options);
    options.engine = engine;
    options.target = target;
    options.face_rule = rule;
    return &options;
}

#define VISIBILITY(NAME, VARIANT, ENGINE, TARGET, RULE)                                            \
    FAILING_MAKES(NAME, VARIANT, starg_bits, starg_bits_free(out), in.solid,                       \
                  in.skeleton->positions, 3,                                                       \
                  look(STARG_VISIBILITY_##ENGINE, STARG_TARGET_##TARGET, STARG_FACES_##RULE))

static starg_status visibility(starg_context *context) {
    VISIBILITY(starg_visibility, "grid", GRID, FACES, VERTICES);
    VISIBILITY(starg_visibility, "bvh, vertices", BVH, VERTICES, VERTICES);
    VISIBILITY(starg_visibility, "sweep", SWEEP, FACES, VERTICES);
    VISIBILITY(starg_visibility, "contours", CONTOURS, FACES, VERTICES);
    VISIBILITY(starg_visibility, "fastest", FASTEST, FACES, VERTICES);
    VISIBILITY(starg_visibility, "grid, whole", GRID, FACES, WHOLE);
    VISIBILITY(starg_visibility, "contours, whole", CONTOURS, FACES, WHOLE);
    static const double boxes[12] = {0, 0, 0, 1, 1, 1, -9, -9, -9, 9, 9, 9};
    FAILING_MAKES(starg_visibility_region, "boxes", starg_bits, starg_bits_free(out), in.solid,
                  boxes, 2, NULL);
    return STARG_OK;
}

/* ---- skeletons and points ---- */

static starg_status points_result(starg_context *context, starg_status status, double *points,
                                  size_t count) {
    assert_true((status == STARG_OK) == (count > 0));
    failing_result(status, points);
    starg_points_free(context, points);
    return status;
}

static starg_status candidates(starg_context *context, starg_candidates source) {
    double *points = NULL;
    size_t count = 0;
    starg_status status =
        starg_candidate_points(context, in.solid, source, 8, 0.01, &points, &count);
    return points_result(context, status, points, count);
}

static starg_status points_read(starg_context *context) {
    double *points = NULL;
    size_t count = 0;
    starg_status status = starg_points_read(context, failing_input("points.txt"), &points, &count);
    return points_result(context, status, points, count);
}

static starg_status points_read_memory(starg_context *context, input_bytes text) {
    double *points = NULL;
    size_t count = 0;
    starg_status status =
        starg_points_read_memory(context, text.data, text.size, "g", &points, &count);
    return points_result(context, status, points, count);
}

static starg_status poses_read(starg_context *context, bool from_memory) {
    static const char text[] = "1 2 3 0 0 1 0 1 0\n";
    starg_poses poses;
    starg_status status = from_memory
                              ? starg_poses_read_memory(context, text, sizeof text - 1, "p", &poses)
                              : starg_poses_read(context, failing_input("guards.json"), &poses);
    assert_int_equal(status == STARG_OK, poses.points != NULL);
    starg_poses_free(context, &poses);
    return status;
}

/* ---- scenes ---- */

/* With the room itself as an obstacle in it, open and closed. */
static starg_status scene_of(starg_context *context, bool soup) {
    const starg_mesh *obstacles[] = {in.room};
    starg_space_options options;
    starg_solid *scene = NULL;
    starg_space_options_default(&options);
    options.soup = soup;
    options.outside = !soup;
    options.standoff_most = 1;
    options.cell = soup ? 0.5 : 0;
    uint32_t faces[] = {0, 1, 3};
    options.over = options.mount = faces;
    options.over_count = soup ? 0 : 3;
    options.mount_count = 3;
    options.height = options.mount_distance = 10;
    double lower[3], upper[3];
    starg_mesh_bounds(in.room, lower, upper);
    for (int k = 0; k < 3; k++)
        options.from[k] = lower[k] - 0.6;
    starg_status status = starg_space_create(context, in.room, obstacles, 1, &options, &scene);
    failing_result(status, scene);
    starg_solid_free(scene);
    return status;
}

static starg_status weigh(starg_context *context) {
    starg_solid *scene = NULL;
    failing_pause();
    starg_status status = starg_space_create(context, in.room, NULL, 0, NULL, &scene);
    failing_resume();
    if (status == STARG_OK)
        status = starg_space_weigh(scene, NULL);
    starg_solid_free(scene);
    return status;
}

static starg_status weights_read(starg_context *context, bool of_faces) {
    size_t faces = of_faces ? starg_mesh_face_count(in.room) : 3;
    const char *file = failing_input(of_faces ? "faces.txt" : "weights.txt");
    double *out = NULL;
    starg_status status = of_faces ? starg_faces_read(context, file, faces, &out)
                                   : starg_weights_read(context, file, faces, &out);
    failing_result(status, out);
    starg_weights_free(context, out);
    return status;
}

static starg_status faces_named(starg_context *context) {
    double *out = NULL;
    starg_status status = starg_faces_named(context, failing_input("named.obj"), "a", 2, &out);
    failing_result(status, out);
    starg_weights_free(context, out);
    return status;
}

static starg_status name_obstacles(starg_context *context) {
    static const char *const files[] = {"a.off", "b.off"};
    starg_guard_obstacle obstacles[2] = {{NULL, 0, 0}, {NULL, 0, 0}};
    starg_guards guards = {.obstacle_count = 2, .obstacles = obstacles};
    starg_status status = starg_guards_name_obstacles(context, &guards, files);
    for (int i = 0; i < 2; i++)
        starg_text_free(context, obstacles[i].file);
    return status;
}

static starg_status unseen(starg_context *context) {
    uint8_t *out = NULL;
    starg_status status = starg_unseen(context, in.solid, NULL, 0, 1000, &out);
    failing_result(status, out);
    starg_unseen_free(context, out);
    return status;
}

static starg_status scene_again(starg_context *context) {
    starg_solid *out = NULL;
    starg_status status = starg_guards_scene(context, in.room, NULL, in.guards, &out);
    failing_result(status, out);
    starg_solid_free(out);
    return status;
}

static starg_status see_again(starg_context *context) {
    starg_bits *out = NULL;
    starg_status status = starg_guards_see(context, in.solid, in.guards, &out);
    failing_result(status, out);
    starg_bits_free(out);
    return status;
}

static starg_status patches(starg_context *context) {
    starg_mesh *mesh = NULL;
    starg_bits *seen = NULL;
    uint32_t *missing = NULL;
    size_t count = 0;
    in.guards->options.visibility.patch = 0.25;
    starg_status status =
        starg_guards_patches(context, in.solid, in.guards, &mesh, &seen, &missing, &count);
    in.guards->options.visibility.patch = STARG_PATCH_AUTO;
    failing_result(status, mesh);
    starg_mesh_free(mesh);
    starg_bits_free(seen);
    starg_patches_free(context, missing);
    return status;
}

static starg_status audit(starg_context *context) {
    starg_guards *out = NULL;
    starg_visibility_options view;
    starg_visibility_options_default(&view);
    const starg_poses poses = {.points = in.guards->positions, .count = in.guards->count};
    starg_status status = starg_guards_audit(context, in.solid, &poses, &view, &out);
    failing_result(status, out);
    starg_guards_free(context, out);
    return status;
}

static starg_status patch_faces(starg_context *context) {
    uint32_t *faces = NULL;
    size_t count = 0;
    starg_status status = starg_guards_patch_faces(context, in.solid, in.guards, &faces, &count);
    failing_result(status, faces);
    starg_patches_free(context, faces);
    return status;
}

static starg_status face_groups(starg_context *context) {
    starg_face_groups groups;
    starg_status status = starg_face_groups_read(context, failing_input("named.obj"), &groups);
    starg_face_groups_free(context, &groups);
    return status;
}

static starg_status name_zones(starg_context *context) {
    starg_guard_zone zone = {.face_count = 1};
    starg_guards guards = {.zone_count = 1, .zones = &zone};
    const char *file = "zone.off";
    starg_status status = starg_guards_name_zones(context, &guards, &file);
    starg_text_free(context, zone.file);
    return status;
}

static starg_status needs(starg_context *context) {
    starg_solid *scene = NULL;
    const starg_face_need need = {.face = 0, .times = 2};
    starg_status status =
        starg_space_create(context, starg_solid_mesh(in.solid), NULL, 0, NULL, &scene);
    if (status == STARG_OK)
        status = starg_space_require(scene, &need, 1);
    starg_solid_free(scene);
    return status;
}

static starg_status scenes(starg_context *context) {
    FAILING_BY(starg_space_create, "outside", scene_of(context, false));
    FAILING_BY(starg_space_create, "soup", scene_of(context, true));
    FAILING_BY(starg_space_weigh, "", weigh(context));
    FAILING_BY(starg_faces_read, "", weights_read(context, true));
    FAILING_BY(starg_weights_read, "", weights_read(context, false));
    FAILING_BY(starg_faces_named, "", faces_named(context));
    FAILING_BY(starg_face_groups_read, "", face_groups(context));
    FAILING_BY(starg_guards_name_obstacles, "", name_obstacles(context));
    FAILING_BY(starg_unseen, "", unseen(context));
    FAILING_BY(starg_guards_scene, "", scene_again(context));
    FAILING_BY(starg_guards_see, "", see_again(context));
    FAILING_BY(starg_guards_patches, "", patches(context));
    FAILING_BY(starg_guards_audit, "", audit(context));
    FAILING_BY(starg_guards_patch_faces, "", patch_faces(context));
    FAILING_BY(starg_space_require, "", needs(context));
    FAILING_BY(starg_guards_name_zones, "", name_zones(context));
    FAILING(starg_guards_write_table, "", in.solid, in.guards, NULL, failing_output("t.csv"));
    FAILING(starg_guards_write_summary, "", in.solid, in.guards, NULL, failing_output("s.csv"));
    FAILING(starg_sheet_write, "", &(const starg_sheet){.scene = in.solid, .guards = in.guards},
            failing_output("s.html"));
    FAILING(starg_guards_write_curve, "", in.guards, true, failing_output("c.svg"));
    FAILING(starg_guards_write_matrix, "", in.guards, failing_output("m.txt"));
    FAILING(starg_guards_write_poses, "csv", in.guards, true, failing_output("p.csv"));
    FAILING(starg_guards_write_poses, "json", in.guards, false, failing_output("p.json"));
    FAILING_BY(starg_poses_read, "", poses_read(context, false));
    FAILING_BY(starg_poses_read_memory, "", poses_read(context, true));
    return STARG_OK;
}

#define SKELETON(NAME, VARIANT, ...)                                                               \
    FAILING_MAKES(NAME, VARIANT, starg_skeleton, starg_skeleton_free(context, out), __VA_ARGS__)
#define SKELETON_WRITE(NAME, ENDING)                                                               \
    FAILING(NAME, ENDING, in.skeleton, failing_output("s." ENDING), STARG_SKELETON_AUTO)

static starg_status skeletons(starg_context *context) {
    starg_skeleton_options options;
    starg_skeleton_options_default(&options);
    options.node_count = 10;
    SKELETON(starg_skeleton_create, "", in.solid, &options);
    SKELETON_WRITE(starg_skeleton_write, "obj");
    SKELETON_WRITE(starg_skeleton_write, "cg");
    SKELETON_WRITE(starg_skeleton_write, "vtk");
    SKELETON(starg_skeleton_read, "obj", failing_input("skeleton.obj"));
    SKELETON(starg_skeleton_read, "cg", failing_input("skeleton.cg"));
    SKELETON(starg_skeleton_read_memory, "vtk", skeleton_text.data, skeleton_text.size, "s");
    FAILING_BY(starg_candidate_points, "medial", candidates(context, STARG_CANDIDATES_MEDIAL));
    FAILING_BY(starg_candidate_points, "interior", candidates(context, STARG_CANDIDATES_INTERIOR));
    FAILING_BY(starg_candidate_points, "skeleton", candidates(context, STARG_CANDIDATES_SKELETON));
    return STARG_OK;
}

/* ---- guards ---- */

static starg_guard_options few(void) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 8;
    options.refine_lines = 1000;
    return options;
}

/* Guards with `o`, modified by SETTINGS. */
#define GUARD(NAME, VARIANT, SETTINGS)                                                             \
    FAILING_MAKES(NAME, VARIANT, starg_guards, starg_guards_free(context, out), in.solid,          \
                  (SETTINGS, &o))
/* With a range, so that several are needed. */
static starg_guard_options proving(void) {
    starg_guard_options options = few();
    options.prove = true;
    options.prove_work = 3000;
    options.visibility.range = 2;
    return options;
}

static starg_status certified(starg_context *context) {
    const starg_guard_options options = proving();
    starg_guards *out = NULL;
    char *text = NULL;
    size_t size = 0;
    starg_status status = starg_guard_certified(context, in.solid, &options, &out, &text, &size);
    assert_true((status == STARG_OK) == (text != NULL) && (text != NULL) == (size > 0));
    failing_result(status, out);
    starg_text_free(context, text);
    starg_guards_free(context, out);
    return status;
}

#define GUARDS(NAME, VARIANT, ...)                                                                 \
    FAILING_MAKES(NAME, VARIANT, starg_guards, starg_guards_free(context, out), __VA_ARGS__)

static starg_status guards(starg_context *context) {
    starg_guard_options o = few();
    GUARD(starg_guard, "pilp, levels, refined", (o.coarsest = 6, o.step = 4, o.significance = 0.5));
    GUARD(starg_guard, "ilp, twice",
          (o.method = STARG_GUARD_ILP, o.candidates = STARG_CANDIDATES_MEDIAL, o.redundancy = 2));
    GUARD(starg_guard, "greedy, vertices, part",
          (o.method = STARG_GUARD_GREEDY, o.candidates = STARG_CANDIDATES_INTERIOR,
           o.visibility.target = STARG_TARGET_VERTICES, o.coverage = 0.9));
    GUARD(starg_guard, "given points, whole",
          (o.candidates = STARG_CANDIDATES_GIVEN, o.points = in.guards->positions,
           o.point_count = in.guards->count, o.visibility.face_rule = STARG_FACES_WHOLE));
    GUARD(starg_guard, "cone, at most 2",
          (o.candidates = STARG_CANDIDATES_INTERIOR, o.visibility.cone = 120, o.max_guards = 2));
    GUARD(starg_guard, "field of view, twice, apart",
          (o = few(), o.candidates = STARG_CANDIDATES_INTERIOR, o.visibility.fov[0] = 90,
           o.visibility.fov[1] = 60, o.visibility.incidence = 80, o.redundancy = 2,
           o.baseline = 20));
    GUARD(starg_guard, "anywhere, at most 2", (o = proving(), o.max_guards = 2));
    GUARD(starg_guard, "anywhere, twice", (o = proving(), o.redundancy = 2));
    GUARD(starg_guard, "anywhere, given points",
          (o = proving(), o.candidates = STARG_CANDIDATES_GIVEN, o.points = in.guards->positions,
           o.point_count = in.guards->count));
    GUARD(starg_guard, "anywhere", (o.prove = true, o.prove_work = 3000, o.visibility.range = 2));
    FAILING_BY(starg_guard_certified, "", certified(context));
    FAILING_MAKES(starg_certificate_read_memory, "", starg_certificate, starg_certificate_free(out),
                  why_text.data, why_text.size, "c");
    FAILING_MAKES(starg_certificate_outline_create, "", starg_certificate_outline,
                  starg_certificate_outline_free(context, out), why);
    FAILING_MAKES(starg_verify_guards_with, "", starg_verdict, starg_verdict_free(context, out),
                  in.room, &(starg_guards_evidence){.certificate = why}, proven);
    FAILING(starg_certificate_write, "", why_text.data, why_text.size, failing_output("c.txt"));
    GUARDS(starg_guards_given, "", in.solid, in.guards->positions, in.guards->count);
    FAILING(starg_guards_write, "", in.guards, "room.off", failing_output("g.json"));
    FAILING_TEXT(starg_guards_write_memory, "", in.guards, "room.off");
    FAILING_TEXT(starg_fields_json, "", starg_guard_options_fields(), &in.guards->options);
    GUARDS(starg_guards_read, "", failing_input("guards.json"));
    GUARDS(starg_guards_read_memory, "", guards_text.data, guards_text.size, "g");
    FAILING_BY(starg_points_read, "", points_read(context));
    FAILING_BY(starg_points_read_memory, "of guards", points_read_memory(context, guards_text));
    FAILING_BY(starg_points_read_memory, "of a skeleton",
               points_read_memory(context, skeleton_text));
    FAILING_MAKES(starg_verify_guards, "", starg_verdict, starg_verdict_free(context, out), in.room,
                  in.guards);
    return STARG_OK;
}

FAILING_TEST(covers)
FAILING_TEST(visibility)
FAILING_TEST(scenes)
FAILING_TEST(skeletons)
FAILING_TEST(guards)

/* Steiner triples on nine points: all rows are alike, and the bound is below the optimum, so that
 * the search must decide. */
static starg_bits *make_triples(starg_context *context) {
    static const int lines[12][3] = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {0, 3, 6},
                                     {1, 4, 7}, {2, 5, 8}, {0, 4, 8}, {1, 5, 6},
                                     {2, 3, 7}, {0, 5, 7}, {1, 3, 8}, {2, 4, 6}};
    starg_bits *bits = NULL;
    test_ok(context, starg_bits_create(context, 9, 12, &bits));
    for (size_t line = 0; line < 12; line++)
        for (size_t k = 0; k < 3; k++)
            starg_bits_set(bits, (size_t)lines[line][k], line);
    return bits;
}

static int set_up(void **state) {
    (void)state;
    failing_inputs_make(&in);
    cover_rows = make_triples(in.context);
    guards_text = failing_input_bytes("guards.json");
    skeleton_text = failing_input_bytes("skeleton.vtk");
    const starg_guard_options options = proving();
    test_ok(in.context, starg_guard_certified(in.context, in.solid, &options, &proven,
                                              &why_text.data, &why_text.size));
    test_ok(in.context,
            starg_certificate_read_memory(in.context, why_text.data, why_text.size, "c", &why));
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(guards_text.data);
    free(skeleton_text.data);
    starg_text_free(in.context, why_text.data);
    starg_guards_free(in.context, proven);
    starg_certificate_free(why);
    starg_bits_free(cover_rows);
    failing_inputs_free(&in);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_covers), cmocka_unit_test(test_visibility),
        cmocka_unit_test(test_scenes), cmocka_unit_test(test_skeletons),
        cmocka_unit_test(test_guards),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
