/* SPDX-License-Identifier: Apache-2.0 */
/* Progress callbacks: nested stages, each from 0 to 1, never decreasing. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/context.h"
#include "core/rng.h"
#include "models.h"
#include "starguard/check.h"
#include "starguard/cover.h"
#include "starguard/decompose.h"
#include "starguard/descriptor.h"

static const char *const NAMES[] = {"bound",        "candidates", "check",       "grow regions",
                                    "augmentation", "decompose",  "delaunay",    "descriptor",
                                    "growth",       "ilp",        "join",        "kernel",
                                    "levels",       "map",        "medial axis", "medial complex",
                                    "pieces",       "planes",     "reduce",      "search",
                                    "sight",        "simplify",   "spectrum",    "sphere",
                                    "tetrahedra",   "thickness",  "visibility",  "views",
                                    "d2",           "erosion",    "signature"};

enum { DEEPEST = 16 };

typedef struct recorder {
    starg_context *context;
    const char *stages[DEEPEST];
    double fractions[DEEPEST];
    size_t depth, calls;
    size_t ilp_steps;  /* different fractions of it */
    bool refined;      /* in some run, "visibility" was inside "search" */
    const char *wrong; /* the first violation, or NULL */
} recorder;

static bool is_known(const char *stage) {
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        if (strcmp(NAMES[i], stage) == 0)
            return true;
    return false;
}

static void complain(recorder *r, const char *what, const char *stage, double fraction) {
    if (r->wrong == NULL)
        printf("%s: '%s' at %g inside of '%s'\n", what, stage, fraction,
               r->depth > 0 ? r->stages[r->depth - 1] : "");
    r->wrong = what;
}

static void open_stage(recorder *r, const char *stage) {
    if (!is_known(stage))
        complain(r, "unknown stage", stage, 0);
    if (r->depth == DEEPEST) {
        complain(r, "too deep", stage, 0);
        return;
    }
    bool inside = r->depth > 0 && strcmp(r->stages[0], "search") == 0;
    r->refined |= inside && strcmp(stage, "visibility") == 0;
    r->stages[r->depth] = stage;
    r->fractions[r->depth++] = 0;
}

static bool record(void *user, const char *stage, double fraction) {
    recorder *r = user;
    r->calls++;
    if (fraction == 0) {
        open_stage(r, stage);
        return true;
    }
    if (r->depth == 0 || strcmp(r->stages[r->depth - 1], stage) != 0) {
        complain(r, "not the innermost stage", stage, fraction);
        return true;
    }
    double *last = &r->fractions[r->depth - 1];
    if (!(fraction >= *last && fraction <= 1))
        complain(r, "not ascending", stage, fraction);
    r->ilp_steps += strcmp(stage, "ilp") == 0 && fraction > *last && fraction < 1;
    *last = fraction;
    if (fraction == 1)
        r->depth--;
    return true;
}

/* Receives every step, without a pause between steps. */
static recorder recorder_new(int threads) {
    recorder r = {.context = test_context(threads)};
    r.context->progress.pause = 0;
    return r;
}

static void listen(recorder *r) {
    r->context->progress.report = record;
    r->context->progress.user = r;
    r->calls = 0;
}

/* Every stage that began has ended. */
static void expect_end(recorder *r) {
    r->context->progress.report = NULL;
    assert_null(r->wrong);
    assert_true(r->calls > 0);
    assert_int_equal(r->depth, 0);
    assert_true(r->fractions[0] == 1);
    assert_int_equal(r->context->progress.depth, 0);
}

static void test_check(void **state) {
    (void)state;
    recorder r = recorder_new(2);
    starg_mesh *mesh = test_sample_mesh(r.context, "cat", 800);
    starg_check *check = NULL;
    listen(&r);
    test_ok(r.context, starg_mesh_check(r.context, mesh, &check));
    expect_end(&r);
    starg_check_free(r.context, check);
    starg_mesh_free(mesh);
    test_context_free(r.context);
}

static void test_guards(void **state) {
    (void)state;
    recorder r = recorder_new(2);
    starg_solid *solid = test_sample(r.context, "cat", 800);
    for (int variant = 0; variant < 5; variant++) {
        starg_guard_options options;
        starg_guard_options_default(&options);
        options.coarsest = 200;
        options.step = STARG_QUARTERS;
        options.method = variant == 1   ? STARG_GUARD_ILP
                         : variant == 2 ? STARG_GUARD_GREEDY
                                        : STARG_GUARD_PILP;
        options.coverage = variant == 3 ? 0.9 : 1;
        options.max_guards = variant == 4 ? 3 : 0;
        starg_guards *guards = NULL;
        listen(&r);
        test_ok(r.context, starg_guard(r.context, solid, &options, &guards));
        expect_end(&r);
        starg_guards_free(r.context, guards);
    }
    assert_true(r.refined);
    starg_solid_free(solid);
    test_context_free(r.context);
}

static void test_decompositions(void **state) {
    (void)state;
    recorder r = recorder_new(2);
    starg_solid *solid = test_sample(r.context, "cat", 500);
    for (int mode = 0; mode < 2; mode++) {
        starg_decompose_options options;
        starg_decompose_options_default(&options);
        options.mode = mode == 0 ? STARG_DECOMPOSE_STRICT : STARG_DECOMPOSE_PAPER;
        options.effort = 200;
        starg_decomposition *d = NULL;
        listen(&r);
        test_ok(r.context, starg_decompose(r.context, solid, &options, &d));
        expect_end(&r);
        starg_decomposition_free(r.context, d);
    }
    starg_solid_free(solid);
    test_context_free(r.context);
}

static void test_descriptors(void **state) {
    (void)state;
    recorder r = recorder_new(2);
    starg_mesh *mesh = test_sample_mesh(r.context, "cat", 800);
    starg_descriptor *descriptor = NULL;
    listen(&r);
    test_ok(r.context, starg_descriptor_create(r.context, mesh, NULL, &descriptor));
    expect_end(&r);
    starg_descriptor_free(r.context, descriptor);
    starg_mesh_free(mesh);
    test_context_free(r.context);
}

static void test_morphs(void **state) {
    (void)state;
    recorder r = recorder_new(2);
    starg_mesh *a = test_pose(r.context, "horse", 0, 500), *b = test_pose(r.context, "cat", 1, 500);
    double *images = malloc(3 * starg_mesh_vertex_count(a) * sizeof *images);
    assert_non_null(images);
    starg_map *map = NULL;
    listen(&r);
    test_ok(r.context, starg_map_create(r.context, a, b, NULL, &map));
    expect_end(&r);
    starg_map_positions(map, b, images);
    listen(&r);
    starg_morph *morph = test_morph(r.context, a, images, STARG_MORPH_STAR);
    expect_end(&r);
    starg_morph_free(morph);
    starg_map_free(r.context, map);
    free(images);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(r.context);
}

/* Branch and bound reports the share of its nodes used, not a constant half. */
static void test_ilp(void **state) {
    (void)state;
    enum { ROWS = 90, COLUMNS = 90, ONES = 6 };
    recorder r = recorder_new(1);
    starg_bits *rows = NULL;
    starg_rng rng = starg_rng_make(5, 0, 0);
    test_ok(r.context, starg_bits_create(r.context, ROWS, COLUMNS, &rows));
    for (size_t i = 0; i < ROWS; i++)
        for (int k = 0; k < ONES; k++)
            starg_bits_set(rows, i, starg_rng_below(&rng, COLUMNS));
    starg_cover_problem problem;
    starg_cover_problem_default(&problem);
    problem.rows = rows;
    starg_cover *cover = NULL;
    listen(&r);
    test_ok(r.context, starg_cover_solve(r.context, &problem, NULL, &cover));
    expect_end(&r);
    assert_true(r.ilp_steps > 2);
    starg_cover_free(cover);
    starg_bits_free(rows);
    test_context_free(r.context);
}

/* A part advances the enclosing stage; a nested stage of the same name is not a new one; decreasing
 * steps are not reported. */
static void test_shares(void **state) {
    (void)state;
    recorder r = recorder_new(1);
    listen(&r);
    starg_progress_begin(r.context, "growth");
    starg_progress_begin_part(r.context, "check", 0.5);
    starg_progress_step(r.context, 1, 2);
    starg_progress_step(r.context, 1, 4);
    assert_true(r.fractions[1] == 0.5);
    starg_progress_step(r.context, 2, 2);
    assert_int_equal(r.depth, 2);
    starg_progress_end(r.context);
    starg_progress_begin_part(r.context, "growth", 0.25);
    assert_int_equal(r.depth, 1);
    starg_progress_step(r.context, 1, 2);
    assert_true(r.fractions[0] == 0.625);
    starg_progress_end(r.context);
    starg_progress_step(r.context, 1, 10);
    assert_true(r.fractions[0] == 0.75);
    for (int i = 0; i < 2 * STARG_STAGES; i++)
        starg_progress_begin(r.context, i % 2 ? "check" : "join");
    for (int i = 0; i < 2 * STARG_STAGES; i++)
        starg_progress_end(r.context);
    starg_progress_end(r.context);
    expect_end(&r);
    test_context_free(r.context);
}

/* Rules of the time limit: one that lets a stage run to its end applies to all its parts. */
static void test_time_rules(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    assert_false(starg_time_is_over(context));
    context->deadline.at = starg_clock() - 1;
    assert_true(starg_time_is_over(context));
    assert_int_equal(starg_check_cancel(context, "check"), STARG_OK);
    starg_time_rule outer = starg_time_begin(context, STARG_TIME_FAILS);
    assert_int_equal(starg_check_cancel(context, "check"), STARG_ERROR_TIME);
    starg_time_rule middle = starg_time_begin(context, STARG_TIME_IGNORED);
    starg_time_rule inner = starg_time_begin(context, STARG_TIME_FAILS);
    assert_int_equal(starg_check_cancel(context, "check"), STARG_OK);
    assert_false(starg_time_is_over(context));
    starg_time_end(context, inner);
    assert_false(starg_time_is_over(context));
    starg_time_end(context, middle);
    assert_true(starg_time_has_failed(context));
    starg_time_end(context, outer);
    assert_int_equal(starg_check_cancel(context, "check"), STARG_OK);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_check),          cmocka_unit_test(test_guards),
        cmocka_unit_test(test_decompositions), cmocka_unit_test(test_descriptors),
        cmocka_unit_test(test_morphs),         cmocka_unit_test(test_ilp),
        cmocka_unit_test(test_shares),         cmocka_unit_test(test_time_rules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
