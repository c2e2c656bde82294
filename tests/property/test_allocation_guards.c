/* Memory that fails at every place of the calls about guards: bits, covers, visibility, skeletons,
 * candidates, guards, and what verifies them. */
#include "failing.h"
#include "failing_inputs.h"

#include <stdlib.h>

#include "starguard/cover.h"

static failing_inputs in;
static starg_bits *cover_rows;
static input_bytes guards_text, skeleton_text;

/* ---- bits and covers ---- */

static starg_status bits_create(starg_context *context) {
    starg_bits *bits = NULL;
    starg_status status = starg_bits_create(context, 3, 70, &bits);
    failing_result(status, bits);
    starg_bits_free(bits);
    return status;
}

static starg_status cover_of(starg_context *context, const starg_cover_problem *problem,
                             starg_cover_method method) {
    starg_cover_options options;
    starg_cover *cover = NULL;
    starg_cover_options_default(&options);
    options.method = method;
    options.max_nodes = 20;
    options.prices = true;
    starg_status status = starg_cover_solve(context, problem, &options, &cover);
    failing_result(status, cover);
    starg_cover_free(cover);
    return status;
}

static starg_cover_problem cover_problem(void) {
    starg_cover_problem problem;
    starg_cover_problem_default(&problem);
    problem.rows = cover_rows;
    return problem;
}

static starg_status cover_greedy(starg_context *context) {
    const starg_cover_problem problem = cover_problem();
    return cover_of(context, &problem, STARG_COVER_GREEDY);
}

static starg_status cover_ilp(starg_context *context) {
    const starg_cover_problem problem = cover_problem();
    return cover_of(context, &problem, STARG_COVER_ILP);
}

static starg_status cover_lp(starg_context *context) {
    const starg_cover_problem problem = cover_problem();
    return cover_of(context, &problem, STARG_COVER_LP);
}

static starg_status cover_redundant(starg_context *context) {
    starg_cover_problem problem = cover_problem();
    static const uint32_t given[] = {1};
    problem.redundancy = 2;
    problem.given = given;
    problem.given_count = 1;
    return cover_of(context, &problem, STARG_COVER_ILP);
}

static starg_status cover_partial(starg_context *context) {
    starg_cover_problem problem = cover_problem();
    problem.target = 9;
    return cover_of(context, &problem, STARG_COVER_ILP);
}

static starg_status cover_limited(starg_context *context) {
    starg_cover_problem problem = cover_problem();
    problem.max_rows = 3;
    return cover_of(context, &problem, STARG_COVER_ILP);
}

/* ---- visibility ---- */

static starg_status visibility_of(starg_context *context, starg_visibility_engine engine,
                                  starg_target target, starg_face_rule rule) {
    starg_visibility_options options;
    starg_bits *bits = NULL;
    starg_visibility_options_default(&options);
    options.engine = engine;
    options.target = target;
    options.face_rule = rule;
    starg_status status =
        starg_visibility(context, in.solid, in.skeleton->positions, 3, &options, &bits);
    failing_result(status, bits);
    starg_bits_free(bits);
    return status;
}

static starg_status visibility_grid(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_GRID, STARG_TARGET_FACES, STARG_FACES_VERTICES);
}

static starg_status visibility_bvh(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_BVH, STARG_TARGET_VERTICES,
                         STARG_FACES_VERTICES);
}

static starg_status visibility_sweep(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_SWEEP, STARG_TARGET_FACES, STARG_FACES_VERTICES);
}

static starg_status visibility_contours(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_CONTOURS, STARG_TARGET_FACES,
                         STARG_FACES_VERTICES);
}

static starg_status visibility_fastest(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_FASTEST, STARG_TARGET_FACES,
                         STARG_FACES_VERTICES);
}

static starg_status visibility_whole(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_GRID, STARG_TARGET_FACES, STARG_FACES_WHOLE);
}

static starg_status visibility_whole_contours(starg_context *context) {
    return visibility_of(context, STARG_VISIBILITY_CONTOURS, STARG_TARGET_FACES, STARG_FACES_WHOLE);
}

/* ---- skeletons ---- */

static starg_status skeleton_result(starg_context *context, starg_status status,
                                    starg_skeleton *skeleton) {
    failing_result(status, skeleton);
    starg_skeleton_free(context, skeleton);
    return status;
}

static starg_status skeleton_create(starg_context *context) {
    starg_skeleton *skeleton = NULL;
    starg_skeleton_options options;
    starg_skeleton_options_default(&options);
    options.node_count = 10;
    starg_status status = starg_skeleton_create(context, in.solid, &options, &skeleton);
    return skeleton_result(context, status, skeleton);
}

static starg_status skeleton_write_obj(starg_context *context) {
    return starg_skeleton_write(context, in.skeleton, failing_output("s.obj"), STARG_SKELETON_AUTO);
}

static starg_status skeleton_write_cg(starg_context *context) {
    return starg_skeleton_write(context, in.skeleton, failing_output("s.cg"), STARG_SKELETON_AUTO);
}

static starg_status skeleton_write_vtk(starg_context *context) {
    return starg_skeleton_write(context, in.skeleton, failing_output("s.vtk"), STARG_SKELETON_AUTO);
}

static starg_status skeleton_read_obj(starg_context *context) {
    starg_skeleton *skeleton = NULL;
    starg_status status = starg_skeleton_read(context, failing_input("skeleton.obj"), &skeleton);
    return skeleton_result(context, status, skeleton);
}

static starg_status skeleton_read_cg(starg_context *context) {
    starg_skeleton *skeleton = NULL;
    starg_status status = starg_skeleton_read(context, failing_input("skeleton.cg"), &skeleton);
    return skeleton_result(context, status, skeleton);
}

static starg_status skeleton_read_memory(starg_context *context) {
    starg_skeleton *skeleton = NULL;
    starg_status status =
        starg_skeleton_read_memory(context, skeleton_text.data, skeleton_text.size, "s", &skeleton);
    return skeleton_result(context, status, skeleton);
}

/* ---- guards ---- */

static starg_status guards_result(starg_context *context, starg_status status,
                                  starg_guards *guards) {
    failing_result(status, guards);
    starg_guards_free(context, guards);
    return status;
}

static starg_guard_options few_candidates(void) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 8;
    options.refine_lines = 1000;
    return options;
}

static starg_status guard_of(starg_context *context, const starg_guard_options *options) {
    starg_guards *guards = NULL;
    starg_status status = starg_guard(context, in.solid, options, &guards);
    return guards_result(context, status, guards);
}

static starg_status guard_pilp(starg_context *context) {
    starg_guard_options options = few_candidates();
    options.coarsest = 6;
    options.step = 4;
    options.significance = 0.5;
    return guard_of(context, &options);
}

static starg_status guard_ilp(starg_context *context) {
    starg_guard_options options = few_candidates();
    options.method = STARG_GUARD_ILP;
    options.candidates = STARG_CANDIDATES_MEDIAL;
    options.redundancy = 2;
    return guard_of(context, &options);
}

static starg_status guard_greedy(starg_context *context) {
    starg_guard_options options = few_candidates();
    options.method = STARG_GUARD_GREEDY;
    options.candidates = STARG_CANDIDATES_INTERIOR;
    options.visibility.target = STARG_TARGET_VERTICES;
    options.coverage = 0.9;
    return guard_of(context, &options);
}

static starg_status guard_given_points(starg_context *context) {
    starg_guard_options options = few_candidates();
    options.candidates = STARG_CANDIDATES_GIVEN;
    options.points = in.guards->positions;
    options.point_count = in.guards->count;
    options.visibility.face_rule = STARG_FACES_WHOLE;
    return guard_of(context, &options);
}

static starg_status guard_cone(starg_context *context) {
    starg_guard_options options = few_candidates();
    options.candidates = STARG_CANDIDATES_INTERIOR;
    options.visibility.cone = 120;
    options.max_guards = 2;
    return guard_of(context, &options);
}

static starg_status guards_given(starg_context *context) {
    starg_guards *guards = NULL;
    starg_status status =
        starg_guards_given(context, in.solid, in.guards->positions, in.guards->count, &guards);
    return guards_result(context, status, guards);
}

static starg_status points_result(starg_context *context, starg_status status, double *points,
                                  size_t count) {
    assert_true((status == STARG_OK) == (count > 0));
    failing_result(status, points);
    starg_points_free(context, points);
    return status;
}

static starg_status candidates_of(starg_context *context, starg_candidates source) {
    double *points = NULL;
    size_t count = 0;
    starg_status status =
        starg_candidate_points(context, in.solid, source, 8, 0.01, &points, &count);
    return points_result(context, status, points, count);
}

static starg_status candidates_medial(starg_context *context) {
    return candidates_of(context, STARG_CANDIDATES_MEDIAL);
}

static starg_status candidates_interior(starg_context *context) {
    return candidates_of(context, STARG_CANDIDATES_INTERIOR);
}

static starg_status candidates_skeleton(starg_context *context) {
    return candidates_of(context, STARG_CANDIDATES_SKELETON);
}

static starg_status guards_write_memory(starg_context *context) {
    char *text = NULL;
    size_t size;
    starg_status status = starg_guards_write_memory(context, in.guards, "room.off", &text, &size);
    starg_text_free(context, text);
    return status;
}

static starg_status fields_json(starg_context *context) {
    char *text = NULL;
    size_t size;
    starg_status status =
        starg_fields_json(context, starg_guard_options_fields(), &in.guards->options, &text, &size);
    starg_text_free(context, text);
    return status;
}

static starg_status guards_write(starg_context *context) {
    return starg_guards_write(context, in.guards, "room.off", failing_output("g.json"));
}

static starg_status guards_read(starg_context *context) {
    starg_guards *guards = NULL;
    starg_status status = starg_guards_read(context, failing_input("guards.json"), &guards);
    return guards_result(context, status, guards);
}

static starg_status guards_read_memory(starg_context *context) {
    starg_guards *guards = NULL;
    starg_status status =
        starg_guards_read_memory(context, guards_text.data, guards_text.size, "g", &guards);
    return guards_result(context, status, guards);
}

static starg_status points_read(starg_context *context) {
    double *points = NULL;
    size_t count = 0;
    starg_status status = starg_points_read(context, failing_input("points.txt"), &points, &count);
    return points_result(context, status, points, count);
}

static starg_status points_read_memory(starg_context *context) {
    double *points = NULL;
    size_t count = 0;
    starg_status status =
        starg_points_read_memory(context, guards_text.data, guards_text.size, "g", &points, &count);
    return points_result(context, status, points, count);
}

static starg_status verify_guards(starg_context *context) {
    starg_verdict *verdict = NULL;
    starg_status status = starg_verify_guards(context, in.room, in.guards, &verdict);
    failing_result(status, verdict);
    starg_verdict_free(context, verdict);
    return status;
}

/* ---- the tables ---- */

static const failing_call covers[] = {
    {"starg_bits_create", "", bits_create, NULL},
    {"starg_cover_solve", "greedy", cover_greedy, NULL},
    {"starg_cover_solve", "ilp", cover_ilp, NULL},
    {"starg_cover_solve", "lp", cover_lp, NULL},
    {"starg_cover_solve", "redundant, given rows", cover_redundant, NULL},
    {"starg_cover_solve", "a part of the weight", cover_partial, NULL},
    {"starg_cover_solve", "at most 3 rows", cover_limited, NULL},
};

static const failing_call visibility[] = {
    {"starg_visibility", "grid", visibility_grid, NULL},
    {"starg_visibility", "bvh, vertices", visibility_bvh, NULL},
    {"starg_visibility", "sweep", visibility_sweep, NULL},
    {"starg_visibility", "contours", visibility_contours, NULL},
    {"starg_visibility", "fastest", visibility_fastest, NULL},
    {"starg_visibility", "grid, whole", visibility_whole, NULL},
    {"starg_visibility", "contours, whole", visibility_whole_contours, NULL},
};

static const failing_call skeletons[] = {
    {"starg_skeleton_create", "", skeleton_create, NULL},
    {"starg_skeleton_write", "obj", skeleton_write_obj, NULL},
    {"starg_skeleton_write", "cg", skeleton_write_cg, NULL},
    {"starg_skeleton_write", "vtk", skeleton_write_vtk, NULL},
    {"starg_skeleton_read", "obj", skeleton_read_obj, NULL},
    {"starg_skeleton_read", "cg", skeleton_read_cg, NULL},
    {"starg_skeleton_read_memory", "vtk", skeleton_read_memory, NULL},
    {"starg_candidate_points", "medial", candidates_medial, NULL},
    {"starg_candidate_points", "interior", candidates_interior, NULL},
    {"starg_candidate_points", "skeleton", candidates_skeleton, NULL},
};

static const failing_call guards[] = {
    {"starg_guard", "pilp, levels, refined", guard_pilp, NULL},
    {"starg_guard", "ilp, twice", guard_ilp, NULL},
    {"starg_guard", "greedy, vertices, part", guard_greedy, NULL},
    {"starg_guard", "given points, whole", guard_given_points, NULL},
    {"starg_guard", "cone, at most 2", guard_cone, NULL},
    {"starg_guards_given", "", guards_given, NULL},
    {"starg_guards_write", "", guards_write, NULL},
    {"starg_guards_write_memory", "", guards_write_memory, NULL},
    {"starg_fields_json", "", fields_json, NULL},
    {"starg_guards_read", "", guards_read, NULL},
    {"starg_guards_read_memory", "", guards_read_memory, NULL},
    {"starg_points_read", "", points_read, NULL},
    {"starg_points_read_memory", "of guards", points_read_memory, NULL},
    {"starg_verify_guards", "", verify_guards, NULL},
};

static void test_covers(void **state) {
    (void)state;
    FAILING_RUN(covers);
}

static void test_visibility(void **state) {
    (void)state;
    FAILING_RUN(visibility);
}

static void test_skeletons(void **state) {
    (void)state;
    FAILING_RUN(skeletons);
}

static void test_guards(void **state) {
    (void)state;
    FAILING_RUN(guards);
}

/* Steiner's triples on nine points: every row alike, and a bound below the optimum, so that nothing
 * is decided before the search. */
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
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    free(guards_text.data);
    free(skeleton_text.data);
    starg_bits_free(cover_rows);
    failing_inputs_free(&in);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_covers),
        cmocka_unit_test(test_visibility),
        cmocka_unit_test(test_skeletons),
        cmocka_unit_test(test_guards),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
