/* SPDX-License-Identifier: Apache-2.0 */
/* The public function on problems with known answers, at its limits, and with failures. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>
#include <time.h>
#include <unistd.h>

#include "core/context.h"
#include "core/rng.h"
#include "cover_oracle.h"
#include "support.h"

/* Processor seconds, independent of load. */
static double processor_time(void) {
    return (double)clock() / CLOCKS_PER_SEC;
}

static starg_bits *make_bits(starg_context *context, size_t rows, size_t columns) {
    starg_bits *bits;
    test_ok(context, starg_bits_create(context, rows, columns, &bits));
    return bits;
}

static starg_cover *solve(starg_context *context, const starg_cover_problem *problem,
                          starg_cover_method method) {
    starg_cover_options options;
    starg_cover *cover;
    starg_cover_options_default(&options);
    options.method = method;
    test_ok(context, starg_cover_solve(context, problem, &options, &cover));
    return cover;
}

static starg_cover_problem problem_of(const starg_bits *bits) {
    starg_cover_problem problem;
    starg_cover_problem_default(&problem);
    problem.rows = bits;
    return problem;
}

/* `copies` separate cycles of `length` rows; each column is in two adjacent ones. */
static starg_bits *make_cycles(starg_context *context, size_t copies, size_t length) {
    starg_bits *bits = make_bits(context, copies * length, copies * length);
    for (size_t k = 0; k < copies; k++) {
        for (size_t i = 0; i < length; i++) {
            starg_bits_set(bits, k * length + i, k * length + i);
            starg_bits_set(bits, k * length + (i + 1) % length, k * length + i);
        }
    }
    return bits;
}

static void expect_optimum(starg_context *context, starg_bits *bits, uint32_t redundancy,
                           size_t count) {
    starg_cover_problem problem = problem_of(bits);
    problem.redundancy = redundancy;
    starg_cover *cover = solve(context, &problem, STARG_COVER_ILP);
    assert_int_equal(cover->count, count);
    assert_int_equal(cover->lower_bound, count);
    assert_true(cover->optimal && cover->target_reached);
    assert_true(cover_oracle_weight(&problem, cover->rows, cover->count) == cover->weight);
    starg_cover_free(cover);
    cover = solve(context, &problem, STARG_COVER_GREEDY);
    assert_true(cover->lower_bound <= count && count <= cover->count);
    starg_cover_free(cover);
    starg_bits_free(bits);
}

static void known_optima(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    expect_optimum(context, cover_oracle_lines(context, 2), 1,
                   5); /* the largest cap has 4 points */
    expect_optimum(context, cover_oracle_lines(context, 3), 1, 18); /* 9 points */
    expect_optimum(context, cover_oracle_lines(context, 2), 3, 9);
    expect_optimum(context, make_cycles(context, 1, 3), 1, 2);
    expect_optimum(context, make_cycles(context, 1, 31), 1, 16);
    expect_optimum(context, make_cycles(context, 7, 5), 1, 21);
    expect_optimum(context, make_cycles(context, 3, 5), 2, 15);
    test_context_free(context);
}

static void nothing_to_cover(void **state) {
    (void)state;
    static const size_t sizes[][2] = {{0, 0}, {0, 5}, {5, 0}, {5, 70}};
    starg_context *context = test_context(1);
    for (size_t s = 0; s < 4; s++) {
        starg_bits *bits = make_bits(context, sizes[s][0], sizes[s][1]);
        for (int method = STARG_COVER_GREEDY; method <= STARG_COVER_ILP; method++) {
            starg_cover_problem problem = problem_of(bits);
            problem.max_rows = s;
            starg_cover *cover = solve(context, &problem, (starg_cover_method)method);
            assert_int_equal(cover->count, 0);
            assert_int_equal(cover->lower_bound, 0);
            assert_true(cover->weight == 0 && cover->weight_bound == 0);
            assert_true(cover->optimal && cover->target_reached && !cover->time_limited);
            starg_cover_free(cover);
        }
        starg_bits_free(bits);
    }
    test_context_free(context);
}

static void zero_target_and_weights(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_bits *bits = make_cycles(context, 1, 5);
    uint64_t weights[5] = {0, 0, 7, 0, 0};
    starg_cover_problem problem = problem_of(bits);
    problem.target = 0;
    starg_cover *cover = solve(context, &problem, STARG_COVER_ILP);
    assert_true(cover->count == 0 && cover->optimal && cover->target_reached);
    starg_cover_free(cover);
    problem.target = UINT64_MAX;
    problem.weights = weights;
    cover = solve(context, &problem, STARG_COVER_ILP);
    assert_true(cover->count == 1 && cover->weight == 7 && cover->optimal);
    starg_cover_free(cover);
    starg_bits_free(bits);
    test_context_free(context);
}

/* Differences far below a double's precision decide. */
static void huge_weights(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_bits *bits = make_bits(context, 3, 4);
    uint64_t big = (uint64_t)1 << 60;
    uint64_t weights[4] = {big, big, big, 1};
    for (size_t i = 0; i < 3; i++)
        starg_bits_set(bits, i, i);
    starg_bits_set(bits, 1, 3);
    starg_cover_problem problem = problem_of(bits);
    problem.weights = weights;
    problem.max_rows = 1;
    starg_cover *cover = solve(context, &problem, STARG_COVER_ILP);
    assert_true(cover->count == 1 && cover->rows[0] == 1);
    assert_true(cover->weight == big + 1 && cover->weight_bound == big + 1);
    assert_false(cover->target_reached);
    starg_cover_free(cover);
    problem.max_rows = 0;
    problem.target = 2 * big + 1;
    cover = solve(context, &problem, STARG_COVER_ILP);
    assert_true(cover->count == 2 && cover->weight == 2 * big + 1 && cover->optimal);
    starg_cover_free(cover);
    problem.target = 2 * big + 2;
    cover = solve(context, &problem, STARG_COVER_ILP);
    assert_true(cover->count == 3 && cover->optimal);
    starg_cover_free(cover);
    starg_bits_free(bits);
    test_context_free(context);
}

static void refused_arguments(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_bits *bits = make_cycles(context, 1, 3);
    uint64_t weights[3] = {(uint64_t)1 << 61, (uint64_t)1 << 61, 0};
    starg_cover_problem problem = problem_of(NULL);
    starg_cover_options options;
    starg_cover *cover;
    assert_int_equal(starg_cover_solve(context, &problem, NULL, &cover), STARG_ERROR_ARGUMENT);
    assert_null(cover);
    problem.rows = bits;
    problem.redundancy = 0;
    assert_int_equal(starg_cover_solve(context, &problem, NULL, &cover), STARG_ERROR_ARGUMENT);
    problem.redundancy = 1001;
    assert_int_equal(starg_cover_solve(context, &problem, NULL, &cover), STARG_ERROR_ARGUMENT);
    problem.redundancy = 1000;
    test_ok(context, starg_cover_solve(context, &problem, NULL, &cover));
    assert_int_equal(cover->count, 3);
    starg_cover_free(cover);
    problem.weights = weights;
    assert_int_equal(starg_cover_solve(context, &problem, NULL, &cover), STARG_ERROR_ARGUMENT);
    weights[1]--;
    test_ok(context, starg_cover_solve(context, &problem, NULL, &cover));
    starg_cover_free(cover);
    starg_cover_options_default(&options);
    options.method = (starg_cover_method)7;
    assert_int_equal(starg_cover_solve(context, &problem, &options, &cover), STARG_ERROR_ARGUMENT);
    starg_cover_free(NULL);
    starg_bits_free(bits);
    test_context_free(context);
}

/* Sparse random columns: reductions hardly help and the linear relaxation is weak. */
static starg_bits *make_hard(starg_context *context, size_t rows, size_t columns) {
    starg_bits *bits = make_bits(context, rows, columns);
    starg_rng rng = starg_rng_make(1, 20, rows);
    for (size_t j = 0; j < columns; j++) {
        for (int k = 0; k < 6; k++)
            starg_bits_set(bits, starg_rng_below(&rng, rows), j);
    }
    return bits;
}

static void limits_keep_the_bound(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_bits *bits = make_hard(context, 120, 300);
    starg_cover_problem problem = problem_of(bits);
    starg_cover_options options;
    starg_cover *cover;
    starg_cover_options_default(&options);
    for (options.max_nodes = 0; options.max_nodes <= 5; options.max_nodes += 5) {
        test_ok(context, starg_cover_solve(context, &problem, &options, &cover));
        assert_true(cover->target_reached && !cover->time_limited);
        assert_true(cover->lower_bound > 5 && cover->lower_bound < cover->count);
        assert_true(cover->nodes <= options.max_nodes);
        assert_true(cover_oracle_weight(&problem, cover->rows, cover->count) == 300);
        starg_cover_free(cover);
    }
    size_t bound = 0;
    for (double limit = 0.5; bound <= 5;
         limit *= 2) { /* until there is enough time for the bound */
        double start = processor_time();
        starg_context_set_time_limit(context, limit);
        test_ok(context, starg_cover_solve(context, &problem, NULL, &cover));
        assert_true(cover->time_limited && cover->target_reached && !cover->optimal);
        assert_true(processor_time() - start < limit + 5);
        bound = cover->lower_bound;
        starg_cover_free(cover);
    }
    starg_context_set_time_limit(context, 1e-9); /* over before it starts */
    test_ok(context, starg_cover_solve(context, &problem, NULL, &cover));
    assert_true(cover->time_limited && cover->target_reached && !cover->optimal);
    assert_true(cover->count < 60);
    starg_cover_free(cover);
    starg_bits_free(bits);
    test_context_free(context);
}

static bool refuse_stage(void *user, const char *stage, double fraction) {
    const char *refused = user;
    return strcmp(stage, refused) != 0 || fraction == 0;
}

static void cancelled_in_every_stage(void **state) {
    (void)state;
    static char stages[][8] = {"reduce", "bound", "ilp"};
    for (size_t s = 0; s < 3; s++) {
        starg_context_options options;
        starg_context_options_default(&options);
        options.progress = refuse_stage;
        options.progress_user = stages[s];
        starg_context *context;
        assert_int_equal(starg_context_create(&options, &context), STARG_OK);
        starg_bits *bits = make_hard(context, 120, 300);
        starg_cover_problem problem = problem_of(bits);
        starg_cover *cover;
        double start = processor_time();
        assert_int_equal(starg_cover_solve(context, &problem, NULL, &cover), STARG_ERROR_CANCELLED);
        assert_null(cover);
        assert_true(processor_time() - start < 5);
        starg_bits_free(bits);
        test_context_free(context);
    }
}

static bool same_cover(const starg_cover *a, const starg_cover *b) {
    return a->count == b->count && a->weight == b->weight && a->lower_bound == b->lower_bound &&
           a->weight_bound == b->weight_bound && a->nodes == b->nodes &&
           memcmp(a->rows, b->rows, a->count * sizeof *a->rows) == 0;
}

static void same_on_any_threads(void **state) {
    (void)state;
    starg_context *one = test_context(1), *four = test_context(4);
    starg_bits *bits = make_hard(one, 30, 70);
    starg_cover_problem problem = problem_of(bits);
    for (int mode = 0; mode < 4; mode++) {
        problem.redundancy = mode == 1 ? 2 : 1;
        problem.target = mode == 2 ? 60 : UINT64_MAX;
        problem.max_rows = mode == 3 ? 5 : 0;
        starg_cover *a = solve(one, &problem, STARG_COVER_ILP);
        starg_cover *b = solve(four, &problem, STARG_COVER_ILP);
        assert_true(same_cover(a, b));
        starg_cover_free(a);
        starg_cover_free(b);
    }
    starg_bits_free(bits);
    test_context_free(one);
    test_context_free(four);
}

typedef struct parallel_solve {
    starg_context *context;
    const starg_cover_problem *problem;
    starg_cover *cover;
} parallel_solve;

static int solve_in_thread(void *argument) {
    parallel_solve *job = argument;
    return (int)starg_cover_solve(job->context, job->problem, NULL, &job->cover);
}

/* The solver library cannot run two solves at once; callers need not care. */
static void two_solves_at_once(void **state) {
    (void)state;
    parallel_solve jobs[2];
    thrd_t threads[2];
    starg_context *context = test_context(1);
    starg_bits *bits = make_hard(context, 30, 80);
    starg_cover_problem problem = problem_of(bits);
    starg_cover *alone = solve(context, &problem, STARG_COVER_ILP);
    assert_true(alone->nodes > 0 && alone->optimal);
    for (int t = 0; t < 2; t++) {
        jobs[t] = (parallel_solve){.context = test_context(1), .problem = &problem};
        assert_int_equal(thrd_create(&threads[t], solve_in_thread, &jobs[t]), thrd_success);
    }
    for (int t = 0; t < 2; t++) {
        int status;
        thrd_join(threads[t], &status);
        assert_int_equal(status, STARG_OK);
        assert_true(same_cover(jobs[t].cover, alone));
        starg_cover_free(jobs[t].cover);
        test_context_free(jobs[t].context);
    }
    starg_cover_free(alone);
    starg_bits_free(bits);
    test_context_free(context);
}

/* Redirects a file descriptor to `file`; returns a copy of the old one. */
static int redirect(int descriptor, int file) {
    fflush(NULL);
    int old = dup(descriptor);
    assert_true(old >= 0 && dup2(file, descriptor) >= 0);
    return old;
}

static void restore(int descriptor, int old) {
    fflush(NULL);
    dup2(old, descriptor);
    close(old);
}

static void prints_nothing(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_bits *bits = make_hard(context, 30, 80);
    starg_cover_problem problem = problem_of(bits);
    FILE *sink = tmpfile();
    assert_non_null(sink);
    int old_out = redirect(STDOUT_FILENO, fileno(sink));
    int old_err = redirect(STDERR_FILENO, fileno(sink));
    starg_cover *cover;
    starg_status status = starg_cover_solve(context, &problem, NULL, &cover);
    restore(STDOUT_FILENO, old_out);
    restore(STDERR_FILENO, old_err);
    test_ok(context, status);
    assert_true(cover->nodes > 0 && cover->optimal); /* the solver library was used */
    assert_int_equal(lseek(fileno(sink), 0, SEEK_END), 0);
    fclose(sink);
    starg_cover_free(cover);
    starg_bits_free(bits);
    test_context_free(context);
}

/* Makes every allocation of a solve fail in turn; returns their number. */
static size_t fail_each(starg_context *context, size_t *left, const starg_cover_problem *problem,
                        starg_cover_method method) {
    starg_cover_options options;
    starg_cover_options_default(&options);
    options.method = method;
    size_t before = starg_context_live_blocks(context);
    for (size_t n = 0;; n++) {
        starg_cover *cover;
        *left = n;
        starg_status status = starg_cover_solve(context, problem, &options, &cover);
        *left = SIZE_MAX;
        if (status == STARG_OK) {
            starg_cover_free(cover);
            assert_int_equal(starg_context_live_blocks(context), before);
            return n;
        }
        assert_int_equal(status, STARG_ERROR_MEMORY);
        assert_null(cover);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
}

static void memory_runs_out(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(0, &left);
    starg_bits *bits = cover_oracle_lines(context, 2);
    starg_cover_problem problem = problem_of(bits);
    for (int mode = 0; mode < 4; mode++) {
        problem.redundancy = mode == 1 ? 2 : 1;
        problem.target = mode == 2 ? 10 : UINT64_MAX;
        problem.max_rows = mode == 3 ? 3 : 0;
        assert_true(fail_each(context, &left, &problem, STARG_COVER_ILP) > 40);
        assert_true(fail_each(context, &left, &problem, STARG_COVER_GREEDY) > 20);
    }
    starg_bits_free(bits);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_optima),
        cmocka_unit_test(nothing_to_cover),
        cmocka_unit_test(zero_target_and_weights),
        cmocka_unit_test(huge_weights),
        cmocka_unit_test(refused_arguments),
        cmocka_unit_test(limits_keep_the_bound),
        cmocka_unit_test(cancelled_in_every_stage),
        cmocka_unit_test(same_on_any_threads),
        cmocka_unit_test(prints_nothing),
        cmocka_unit_test(two_solves_at_once),
        cmocka_unit_test(memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
