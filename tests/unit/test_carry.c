/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates that are carried from a level of detail to the model, by their definition: with rows
 * of another engine. */
#include "core/rng.h"
#include "guard/stages.h"
#include "models.h"
#include "starguard/visibility.h"

enum { POINTS = 120 };

/* Random points inside; each third one stands twice. */
static void draw_points(starg_context *context, const starg_solid *solid, uint64_t seed,
                        candidate_points *points) {
    starg_rng rng = starg_rng_make(seed, 0, 0);
    double lower[3], upper[3], p[3];
    starg_mesh_bounds(starg_solid_mesh(solid), lower, upper);
    while (candidates_count(points) < POINTS) {
        for (int k = 0; k < 3; k++)
            p[k] = lower[k] + starg_rng_unit(&rng) * (upper[k] - lower[k]);
        if (!starg_solid_contains(solid, p))
            continue;
        test_ok(context, candidates_push(context, points, p, NULL));
        if (candidates_count(points) % 3 == 0)
            test_ok(context, candidates_push(context, points, p, NULL));
    }
}

static bool is_among(const candidate_points *points, const double p[3]) {
    for (size_t i = 0; i < candidates_count(points); i++)
        if (memcmp(points->data.data + 3 * i, p, 3 * sizeof *p) == 0)
            return true;
    return false;
}

static double weigh(const starg_bits *rows, size_t row, const column_weights *weights) {
    double sum = 0;
    for (size_t f = 0; f < starg_bits_columns(rows); f++)
        sum += starg_bits_test(rows, row, f) ? (double)weights->weights[f] : 0;
    return sum;
}

/* Whatever some candidate sees, the one with the heaviest row that sees it is carried. */
static void expect_best(const starg_bits *rows, const column_weights *weights,
                        const candidate_points *all, const candidate_points *carried) {
    double own[2 * POINTS];
    for (size_t i = 0; i < candidates_count(all); i++)
        own[i] = weigh(rows, i, weights);
    for (size_t f = 0; f < starg_bits_columns(rows); f++) {
        double most = -1;
        bool found = false, seen = false;
        for (size_t i = 0; i < candidates_count(all); i++)
            if (starg_bits_test(rows, i, f))
                most = own[i] > most ? own[i] : most, seen = true;
        for (size_t i = 0; i < candidates_count(all) && !found; i++)
            found = starg_bits_test(rows, i, f) && own[i] == most &&
                    is_among(carried, all->data.data + 3 * i);
        assert_true(found || !seen);
    }
}

/* The fewest of some points. */
static size_t fewest(starg_context *context, const starg_solid *solid, starg_guard_options options,
                     const candidate_points *points) {
    starg_guards *guards = NULL;
    options.method = STARG_GUARD_ILP;
    options.candidates = STARG_CANDIDATES_GIVEN;
    options.points = points->data.data;
    options.point_count = candidates_count(points);
    test_ok(context, starg_guard(context, solid, &options, &guards));
    assert_true(guards->optimal);
    size_t count = guards->count;
    starg_guards_free(context, guards);
    return count;
}

static void check_carried(starg_context *context, const char *name, double coverage,
                          size_t redundancy) {
    starg_solid *solid = test_sample(context, name, 500);
    starg_guard_options options;
    candidate_points all = {0}, carried = {0};
    starg_bits *rows = NULL;
    column_weights weights;
    starg_guard_options_default(&options);
    options.coverage = coverage;
    options.redundancy = redundancy;
    options.max_nodes = 10000;
    draw_points(context, solid, 3, &all);
    for (size_t i = 0; i < candidates_count(&all); i++)
        test_ok(context, candidates_push(context, &carried, all.data.data + 3 * i, NULL));
    const guard_problem problem = {.context = context, .solid = solid, .options = &options};
    test_ok(context, carry_candidates(&problem, solid, &carried));
    assert_true(candidates_count(&carried) > 0);
    assert_true(candidates_count(&carried) < candidates_count(&all));
    for (size_t i = 0; i < candidates_count(&carried); i++)
        assert_true(is_among(&all, carried.data.data + 3 * i));

    starg_visibility_options view = options.visibility;
    view.engine = STARG_VISIBILITY_SWEEP;
    test_ok(context,
            starg_visibility(context, solid, all.data.data, candidates_count(&all), &view, &rows));
    test_ok(context, column_weights_create(context, solid, view.target, &weights));
    if (coverage == 1)
        expect_best(rows, &weights, &all, &carried);
    if (coverage == 1 && redundancy == 1)
        assert_int_equal(fewest(context, solid, options, &carried),
                         fewest(context, solid, options, &all));
    column_weights_free(&weights);
    starg_bits_free(rows);
    candidates_free(&all);
    candidates_free(&carried);
    starg_solid_free(solid);
}

static void test_definition(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    check_carried(context, "horse", 1, 1);
    check_carried(context, "gallery", 1, 1);
    check_carried(context, "labyrinth", 1, 1);
    check_carried(context, "labyrinth", 1, 2);
    check_carried(context, "octopus", 0.9, 1);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_definition)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
