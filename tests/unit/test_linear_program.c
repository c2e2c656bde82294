/* SPDX-License-Identifier: Apache-2.0 */
/* Linear programs against the enumeration of all vertices of the arrangement in long double; tight
 * and infeasible rows against their definition. */
#include "support.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/linear_program.h"

enum { MOST_ROWS = 22, STRIDE = LINEAR_PROGRAM_MOST + 1 };

typedef struct problem {
    int dimension;
    size_t count;
    double rows[MOST_ROWS * STRIDE];
    double objective[LINEAR_PROGRAM_MOST];
} problem;

static const double *row_of(const problem *p, size_t i) {
    return p->rows + (size_t)(p->dimension + 1) * i;
}

static void add_row(problem *p, const double *a, double b) {
    double *row = p->rows + (size_t)(p->dimension + 1) * p->count++;
    double length = 0;
    for (int k = 0; k < p->dimension; k++)
        length += a[k] * a[k];
    length = sqrt(length);
    for (int k = 0; k < p->dimension; k++)
        row[k] = a[k] / length;
    row[p->dimension] = b / length;
}

/* -side <= x_k <= side */
static void add_box(problem *p, double side) {
    for (int k = 0; k < 2 * p->dimension; k++) {
        double a[LINEAR_PROGRAM_MOST] = {0};
        a[k / 2] = k % 2 ? -1 : 1;
        add_row(p, a, side);
    }
}

/* Gaussian elimination with full pivoting of rows; false if singular. */
static bool intersect(const problem *p, const size_t *chosen, long double *x) {
    int n = p->dimension;
    long double m[LINEAR_PROGRAM_MOST][STRIDE];
    for (int i = 0; i < n; i++)
        for (int k = 0; k <= n; k++)
            m[i][k] = row_of(p, chosen[i])[k];
    for (int c = 0; c < n; c++) {
        int best = c;
        for (int i = c + 1; i < n; i++)
            if (fabsl(m[i][c]) > fabsl(m[best][c]))
                best = i;
        if (fabsl(m[best][c]) < 1e-9L)
            return false;
        for (int k = 0; k <= n; k++) {
            long double swap = m[c][k];
            m[c][k] = m[best][k];
            m[best][k] = swap;
        }
        for (int i = 0; i < n; i++) {
            long double factor = i == c ? 0 : m[i][c] / m[c][c];
            for (int k = 0; k <= n; k++)
                m[i][k] -= factor * m[c][k];
        }
    }
    for (int c = 0; c < n; c++)
        x[c] = m[c][n] / m[c][c];
    return true;
}

static bool satisfies(const problem *p, const long double *x, long double tolerance) {
    for (size_t i = 0; i < p->count; i++) {
        long double sum = -row_of(p, i)[p->dimension];
        for (int k = 0; k < p->dimension; k++)
            sum += row_of(p, i)[k] * x[k];
        if (sum > tolerance)
            return false;
    }
    return true;
}

/* The best vertex within a tolerance; false if there is none. The rows must bound the problem. */
static bool enumerate(const problem *p, long double tolerance, long double *best) {
    size_t chosen[LINEAR_PROGRAM_MOST];
    int n = p->dimension;
    bool found = false;
    for (int i = 0; i < n; i++)
        chosen[i] = (size_t)i;
    for (;;) {
        long double x[LINEAR_PROGRAM_MOST], value = 0;
        if (intersect(p, chosen, x) && satisfies(p, x, tolerance)) {
            for (int k = 0; k < n; k++)
                value += p->objective[k] * x[k];
            if (!found || value > *best)
                *best = value;
            found = true;
        }
        int at = n - 1;
        while (at >= 0 && chosen[at] == p->count - (size_t)(n - at))
            at--;
        if (at < 0)
            return found;
        chosen[at]++;
        for (int i = at + 1; i < n; i++)
            chosen[i] = chosen[i - 1] + 1;
    }
}

static linear_program as_program(const problem *p, uint64_t seed) {
    linear_program program = {
        .dimension = p->dimension, .rows = p->rows, .count = p->count, .radius = 64, .seed = seed};
    memcpy(program.objective, p->objective, sizeof program.objective);
    return program;
}

/* The reported rows leave no point of a far larger box. */
static void check_infeasible_rows(const problem *p, const linear_solution *solution) {
    problem few = {.dimension = p->dimension};
    assert_in_range(solution->tight_count, 1, p->dimension + 1);
    for (int i = 0; i < solution->tight_count; i++) {
        assert_true(solution->tight[i] < p->count);
        for (int j = 0; j < i; j++)
            assert_int_not_equal(solution->tight[i], solution->tight[j]);
        const double *row = row_of(p, solution->tight[i]);
        add_row(&few, row, row[p->dimension]);
    }
    add_box(&few, 16); /* within the ball */
    long double ignored;
    assert_false(enumerate(&few, -1e-9L, &ignored));
}

/* The tight rows alone determine the objective: the program without the others, in a larger box,
 * has the same value. */
static void check_tight_rows(const problem *p, const linear_solution *solution, double value) {
    problem few = {.dimension = p->dimension};
    memcpy(few.objective, p->objective, sizeof few.objective);
    assert_in_range(solution->tight_count, 0, p->dimension);
    for (int i = 0; i < solution->tight_count; i++) {
        const double *row = row_of(p, solution->tight[i]);
        add_row(&few, row, row[p->dimension]);
    }
    add_box(&few, 1024);
    long double best = 0;
    assert_true(enumerate(&few, 1e-9L, &best));
    assert_true(fabsl(best - (long double)value) < 1e-6L);
}

static double value_of(const problem *p, const double *x) {
    double sum = 0;
    for (int k = 0; k < p->dimension; k++)
        sum += p->objective[k] * x[k];
    return sum;
}

/* Returns whether the program was decided, i.e. not within rounding of the border. */
static bool check_problem(const problem *p, uint64_t seed, size_t *infeasible) {
    uint32_t order[MOST_ROWS];
    linear_solution solution, again;
    long double loose = 0;
    bool loosely = enumerate(p, 1e-9L, &loose);
    linear_program program = as_program(p, seed);
    linear_program_solve(&program, order, NULL, &solution);
    if (!loosely) {
        assert_false(solution.feasible);
        check_infeasible_rows(p, &solution);
        ++*infeasible;
        return true;
    }
    if (!solution.feasible)
        return false; /* counted by the caller */
    long double x[LINEAR_PROGRAM_MOST];
    for (int k = 0; k < p->dimension; k++)
        x[k] = solution.point[k];
    assert_true(satisfies(p, x, 1e-11L));
    double value = value_of(p, solution.point);
    assert_true(fabsl((long double)value - loose) < 1e-7L);
    check_tight_rows(p, &solution, value);

    /* starting from its own solution, another order gives the same value */
    program.seed = seed + 1000;
    linear_program_solve(&program, order, &solution, &again);
    assert_true(again.feasible);
    assert_true(fabs(value_of(p, again.point) - value) < 1e-9);
    return true;
}

static double centered(starg_rng *rng) {
    return 2 * starg_rng_unit(rng) - 1;
}

static void random_objective(problem *p, starg_rng *rng) {
    for (int k = 0; k < p->dimension; k++)
        p->objective[k] = centered(rng);
}

static void test_random(void **state) {
    (void)state;
    size_t infeasible = 0;
    for (int dimension = 1; dimension <= LINEAR_PROGRAM_MOST; dimension++)
        for (uint64_t seed = 0; seed < 150; seed++) {
            starg_rng rng = starg_rng_make(seed, 1, (uint64_t)dimension);
            problem p = {.dimension = dimension};
            add_box(&p, 4);
            size_t more = 1 + starg_rng_below(&rng, 12);
            double depth = seed % 3 == 0 ? 1 : 0.3; /* some cut the origin off */
            for (size_t i = 0; i < more; i++) {
                double a[LINEAR_PROGRAM_MOST];
                for (int k = 0; k < dimension; k++)
                    a[k] = centered(&rng);
                add_row(&p, a, depth * starg_rng_unit(&rng) - (seed % 3 ? 0.15 : 0));
            }
            random_objective(&p, &rng);
            assert_true(check_problem(&p, seed, &infeasible));
        }
    assert_true(infeasible >= 20);
}

/* Small integers: parallel, opposite, repeated rows, many through one point, flat sets. */
static void test_lattice(void **state) {
    (void)state;
    size_t infeasible = 0, feasible = 0;
    for (int dimension = 2; dimension <= LINEAR_PROGRAM_MOST; dimension++)
        for (uint64_t seed = 0; seed < 250; seed++) {
            starg_rng rng = starg_rng_make(seed, 2, (uint64_t)dimension);
            problem p = {.dimension = dimension};
            add_box(&p, 4);
            size_t more = 1 + starg_rng_below(&rng, 12);
            for (size_t i = 0; i < more; i++) {
                double a[LINEAR_PROGRAM_MOST], length = 0;
                for (int k = 0; k < dimension; k++) {
                    a[k] = (double)starg_rng_below(&rng, 3) - 1;
                    length += fabs(a[k]);
                }
                if (length > 0)
                    add_row(&p, a, (double)starg_rng_below(&rng, 4) - (seed % 2 ? 1 : 0));
            }
            for (int k = 0; k < dimension; k++)
                p.objective[k] = (double)starg_rng_below(&rng, 3) - 1;
            size_t before = infeasible;
            assert_true(check_problem(&p, seed, &infeasible));
            feasible += infeasible == before;
        }
    assert_true(infeasible >= 50 && feasible >= 300);
}

/* The ball alone. */
static void test_ball(void **state) {
    (void)state;
    uint32_t order[1];
    linear_solution solution;
    linear_program program = {.dimension = 3,
                              .rows = (const double[]){0, 0, 1, 1},
                              .objective = {3, 0, 4},
                              .center = {1, 2, 3},
                              .radius = 5};
    linear_program_solve(&program, order, NULL, &solution);
    assert_true(solution.feasible && solution.tight_count == 0);
    assert_true(fabs(solution.point[0] - 4) < 1e-12 && fabs(solution.point[1] - 2) < 1e-12 &&
                fabs(solution.point[2] - 7) < 1e-12);
    program.count = 1; /* z <= 1: a disc of radius sqrt(21) about (1, 2, 1) */
    linear_program_solve(&program, order, NULL, &solution);
    assert_true(solution.feasible && solution.tight_count == 1 && solution.tight[0] == 0);
    assert_true(fabs(solution.point[0] - 1 - sqrt(21)) < 1e-12);
    program.center[2] = 7; /* out of reach */
    linear_program_solve(&program, order, NULL, &solution);
    assert_false(solution.feasible);
}

/* Many rows around one ball: the answer is known, every row is nearly tight. */
static void test_many(void **state) {
    (void)state;
    enum { COUNT = 200000 };
    double *rows = malloc(COUNT * 5 * sizeof *rows);
    uint32_t *order = malloc(COUNT * sizeof *order);
    assert_true(rows != NULL && order != NULL);
    starg_rng rng = starg_rng_make(1, 3, 0);
    const double center[3] = {0.25, -0.5, 0.125};
    for (size_t i = 0; i < COUNT; i++) {
        double *row = rows + 5 * i, length = 0;
        for (int k = 0; k < 3; k++) {
            row[k] = centered(&rng);
            length += row[k] * row[k];
        }
        length = sqrt(length);
        row[3] = 1;
        row[4] = 1 + (i % 2 ? 1e-9 * starg_rng_unit(&rng) : 0); /* the unit ball about center */
        for (int k = 0; k < 3; k++) {
            row[k] /= length;
            row[4] += row[k] * center[k];
        }
    }
    linear_program program = {
        .dimension = 4, .rows = rows, .count = COUNT, .objective = {0, 0, 0, 1}, .radius = 8};
    linear_solution solution;
    for (program.seed = 0; program.seed < 5; program.seed++) {
        linear_program_solve(&program, order, NULL, &solution);
        assert_true(solution.feasible && solution.tight_count == 4);
        assert_true(fabs(solution.point[3] - 1) < 1e-8);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(solution.point[k] - center[k]) < 1e-6);
    }
    free(rows);
    free(order);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random),
                                       cmocka_unit_test(test_lattice), cmocka_unit_test(test_ball),
                                       cmocka_unit_test(test_many)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
