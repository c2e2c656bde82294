/* SPDX-License-Identifier: Apache-2.0 */
/* Largest ball in half-spaces, against all choices of four in long double and against a linear
 * program in four variables; its proof, against the definition. */
#include "support.h"

#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "geometry/linear_program.h"

enum { MOST = 30, BOX = 6, ROUNDS = 2000 };

/* Half-spaces; the first six are a box, so that the ball never meets the initial tetrahedron. */
typedef struct problem {
    size_t count;
    double normals[MOST][3], offsets[MOST];
    bool gone[MOST]; /* removed again */
} problem;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void add_plane(problem *p, double x, double y, double z, double offset) {
    double length = sqrt(x * x + y * y + z * z);
    double *n = p->normals[p->count];
    n[0] = x / length, n[1] = y / length, n[2] = z / length;
    p->offsets[p->count++] = offset;
}

static void add_box(problem *p, double side) {
    for (int k = 0; k < BOX; k++) {
        double n[3] = {0};
        n[k / 2] = k % 2 ? -1 : 1;
        add_plane(p, n[0], n[1], n[2], side);
    }
}

static double centred(starg_rng *rng) {
    return 2 * starg_rng_unit(rng) - 1;
}

/* `lowest`: lower bound of offsets; if negative there may be no common point. */
static problem random_problem(starg_rng *rng, size_t extra, double lowest) {
    problem p = {.count = 0};
    add_box(&p, 1);
    for (size_t i = 0; i < extra; i++)
        add_plane(&p, centred(rng), centred(rng), centred(rng), lowest + 0.8 * starg_rng_unit(rng));
    return p;
}

/* Parallel, repeated and nearly equal half-spaces among lattice directions. */
static problem degenerate_problem(starg_rng *rng) {
    static const double nudges[] = {0, 0, 1e-6, 1e-10, 1e-13};
    problem p = {.count = 0};
    add_box(&p, starg_rng_below(rng, 2) == 0 ? 1 : 0.5);
    while (p.count < MOST) {
        double n[3], nudge = nudges[starg_rng_below(rng, 5)];
        if (starg_rng_below(rng, 2) == 0) { /* an existing one, or its opposite */
            size_t i = (size_t)starg_rng_below(rng, p.count);
            double sign = starg_rng_below(rng, 4) == 0 ? -1 : 1;
            for (int k = 0; k < 3; k++)
                n[k] = sign * p.normals[i][k] + nudge * centred(rng);
            add_plane(&p, n[0], n[1], n[2], p.offsets[i] + nudge * centred(rng));
            continue;
        }
        for (int k = 0; k < 3; k++)
            n[k] = (double)starg_rng_below(rng, 3) - 1;
        if (dot(n, n) > 0)
            add_plane(&p, n[0], n[1], n[2], 0.25 * (double)(1 + starg_rng_below(rng, 3)));
    }
    return p;
}

/* ---- slow answers ---- */

/* Solves n_i . x + r = b_i for four planes; false if singular. */
static bool meet_four(const problem *p, const size_t four[4], long double x[4]) {
    long double m[4][5];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 5; k++)
            m[i][k] = k < 3    ? p->normals[four[i]][k]
                      : k == 3 ? 1
                               : (long double)p->offsets[four[i]];
    for (int c = 0; c < 4; c++) {
        int best = c;
        for (int i = c + 1; i < 4; i++)
            best = fabsl(m[i][c]) > fabsl(m[best][c]) ? i : best;
        if (fabsl(m[best][c]) < 1e-10L)
            return false;
        for (int k = 0; k < 5; k++) {
            long double swap = m[c][k];
            m[c][k] = m[best][k];
            m[best][k] = swap;
        }
        for (int i = 0; i < 4; i++) {
            long double factor = i == c ? 0 : m[i][c] / m[c][c];
            for (int k = 0; k < 5; k++)
                m[i][k] -= factor * m[c][k];
        }
    }
    for (int c = 0; c < 4; c++)
        x[c] = m[c][4] / m[c][c];
    return true;
}

static bool fits(const problem *p, const long double x[4]) {
    for (size_t i = 0; i < p->count; i++) {
        const double *n = p->normals[i];
        if (!p->gone[i] && n[0] * x[0] + n[1] * x[1] + n[2] * x[2] + x[3] > p->offsets[i] + 1e-9L)
            return false;
    }
    return true;
}

/* The largest ball that touches four half-spaces and fits into all. */
static double try_all_fours(const problem *p) {
    long double best = -INFINITY, x[4];
    size_t f[4];
    for (f[0] = 0; f[0] < p->count; f[0]++)
        for (f[1] = f[0] + 1; f[1] < p->count; f[1]++)
            for (f[2] = f[1] + 1; f[2] < p->count; f[2]++)
                for (f[3] = f[2] + 1; f[3] < p->count; f[3]++) {
                    if (p->gone[f[0]] || p->gone[f[1]] || p->gone[f[2]] || p->gone[f[3]])
                        continue;
                    if (meet_four(p, f, x) && x[3] > best && fits(p, x))
                        best = x[3];
                }
    return (double)best;
}

static double solve_program(const problem *p, uint64_t seed) {
    double rows[5 * MOST];
    uint32_t order[MOST];
    linear_program program = {
        .dimension = 4, .rows = rows, .objective = {0, 0, 0, 1}, .radius = 16, .seed = seed};
    linear_solution solution;
    for (size_t i = 0; i < p->count; i++) {
        if (p->gone[i])
            continue;
        double *row = rows + 5 * program.count++;
        for (int k = 0; k < 5; k++)
            row[k] = (k < 3 ? p->normals[i][k] : k == 3 ? 1 : p->offsets[i]) / sqrt(2);
    }
    linear_program_solve(&program, order, NULL, &solution);
    assert_true(solution.feasible);
    return solution.point[3];
}

/* ---- the ball's proof ---- */

static void check_proof(const problem *p, const largest_ball *ball, double tolerance) {
    double sum = 0, combination[3] = {0}, bound = 0;
    for (int i = 0; i < 4; i++) {
        uint32_t name = ball->names[i];
        assert_true(ball->weights[i] >= -tolerance);
        sum += ball->weights[i];
        bound += ball->weights[i] * ball->offsets[i];
        for (int k = 0; k < 3; k++)
            combination[k] += ball->weights[i] * ball->normals[i][k];
        if (name != LARGEST_BALL_FAR) {
            assert_true(name < p->count && !p->gone[name]);
            assert_memory_equal(ball->normals[i], p->normals[name], sizeof ball->normals[i]);
            assert_true(ball->offsets[i] == p->offsets[name]);
        } else {
            assert_true(ball->offsets[i] == LARGEST_BALL_DISTANCE);
        }
        assert_true(fabs(dot(ball->normals[i], ball->center) + ball->radius - ball->offsets[i]) <
                    tolerance);
    }
    assert_true(fabs(sum - 1) < tolerance);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(combination[k]) < tolerance);
    assert_true(fabs(bound - ball->radius) < tolerance); /* the four allow no larger ball */
}

/* The half-space that the ball violates most, or a random violated one; MOST: none. */
static size_t find_violated(const problem *p, const largest_ball *ball, starg_rng *rng) {
    size_t found = MOST, seen = 0;
    bool any = starg_rng_below(rng, 2) == 0;
    double worst = -1e-10;
    for (size_t i = 0; i < p->count; i++) {
        double room = p->offsets[i] - dot(p->normals[i], ball->center) - ball->radius;
        if (p->gone[i] || room >= (any ? -1e-10 : worst))
            continue;
        seen++;
        if (any && starg_rng_below(rng, seen) != 0)
            continue;
        worst = room;
        found = i;
    }
    return found;
}

/* Adds violated half-spaces until there are none; false if the ball gives up. */
static bool settle(const problem *p, largest_ball *ball, starg_rng *rng, double tolerance) {
    for (int round = 0; round < ROUNDS; round++) {
        size_t next = find_violated(p, ball, rng);
        double before = ball->radius;
        if (next == MOST)
            return true;
        if (!largest_ball_add(ball, p->normals[next], p->offsets[next], (uint32_t)next))
            return false;
        check_proof(p, ball, tolerance);
        assert_true(ball->radius <= before + tolerance);
    }
    return false;
}

static void check_answer(const problem *p, const largest_ball *ball, uint64_t seed,
                         double tolerance) {
    assert_true(fabs(ball->radius - try_all_fours(p)) < tolerance);
    assert_true(fabs(ball->radius - solve_program(p, seed)) < tolerance);
}

/* ---- tests ---- */

static void test_start(void **state) {
    (void)state;
    largest_ball ball;
    const problem none = {.count = 0};
    largest_ball_start(&ball);
    check_proof(&none, &ball, 1e-14);
    assert_true(fabs(ball.radius - LARGEST_BALL_DISTANCE) < 1e-14);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(ball.center[k]) < 1e-14);
}

static void test_random(void **state) {
    (void)state;
    size_t inside = 0, outside = 0;
    for (uint64_t seed = 0; seed < 150; seed++) {
        starg_rng rng = starg_rng_make(seed, 51, 0);
        problem p = random_problem(&rng, 1 + seed % 18, seed % 2 == 0 ? 0.05 : -0.5);
        largest_ball ball;
        largest_ball_start(&ball);
        assert_true(settle(&p, &ball, &rng, 1e-9));
        check_answer(&p, &ball, seed, 1e-8);
        inside += ball.radius > 0;
        outside += ball.radius < 0;
    }
    assert_true(inside > 30 && outside > 30); /* both kinds occurred */
}

/* Half-spaces are moved far away, one or two at a time, and the ball grows. */
static void test_moved_away(void **state) {
    (void)state;
    size_t grown = 0;
    for (uint64_t seed = 0; seed < 40; seed++) {
        starg_rng rng = starg_rng_make(seed, 52, 0);
        problem p = random_problem(&rng, 14, 0);
        largest_ball ball;
        largest_ball_start(&ball);
        assert_true(settle(&p, &ball, &rng, 1e-9));
        for (int turn = 0; turn < 8; turn++) {
            double before = ball.radius;
            for (int i = 0; i < 4; i++)
                if (ball.names[i] != LARGEST_BALL_FAR && ball.names[i] >= BOX &&
                    starg_rng_below(&rng, 2) == 0) {
                    p.gone[ball.names[i]] = true;
                    largest_ball_move(&ball, i, LARGEST_BALL_DISTANCE, LARGEST_BALL_FAR);
                }
            check_proof(&p, &ball, 1e-9);
            assert_true(settle(&p, &ball, &rng, 1e-9));
            check_answer(&p, &ball, seed, 1e-8);
            assert_true(ball.radius >= before - 1e-9);
            grown += ball.radius > before + 1e-6;
        }
    }
    assert_true(grown > 50);
}

/* Moving a half-space closer equals having it there from the start. */
static void test_moved_nearer(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        starg_rng rng = starg_rng_make(seed, 53, 0);
        problem p = random_problem(&rng, 10, 0.1);
        largest_ball ball;
        largest_ball_start(&ball);
        assert_true(settle(&p, &ball, &rng, 1e-9));
        for (int turn = 0; turn < 6; turn++) {
            int place = (int)starg_rng_below(&rng, 4);
            uint32_t name = ball.names[place];
            assert_int_not_equal(name, LARGEST_BALL_FAR);
            p.offsets[name] -= 0.1 * starg_rng_unit(&rng);
            largest_ball_move(&ball, place, p.offsets[name], name);
            check_proof(&p, &ball, 1e-9);
            assert_true(settle(&p, &ball, &rng, 1e-9));
            check_answer(&p, &ball, seed, 1e-8);
        }
    }
}

/* The ball may give up, but rarely; its results are correct. */
static void test_degenerate(void **state) {
    (void)state;
    size_t settled = 0, count = 60;
    for (uint64_t seed = 0; seed < count; seed++) {
        starg_rng rng = starg_rng_make(seed, 54, 0);
        problem p = degenerate_problem(&rng);
        largest_ball ball;
        largest_ball_start(&ball);
        if (!settle(&p, &ball, &rng, 1e-5))
            continue;
        settled++;
        check_answer(&p, &ball, seed, 1e-7);
    }
    assert_true(settled >= count - 3);
}

/* The same half-space, or all existing ones, repeatedly. */
static void test_repeated(void **state) {
    (void)state;
    problem p = {.count = 0};
    largest_ball ball;
    starg_rng rng = starg_rng_make(1, 55, 0);
    while (p.count < 24)
        add_box(&p, 0.25);
    largest_ball_start(&ball);
    assert_true(settle(&p, &ball, &rng, 1e-9));
    assert_true(fabs(ball.radius - 0.25) < 1e-12);
    /* a slab of zero width: the ball is a point of it */
    add_plane(&p, 1, 1, 0, 0.1);
    add_plane(&p, -1, -1, 0, -0.1);
    assert_true(settle(&p, &ball, &rng, 1e-9));
    assert_true(fabs(ball.radius) < 1e-12);
    /* and a slightly empty one */
    add_plane(&p, -1, -1, 0, -0.1 - 2e-6);
    assert_true(settle(&p, &ball, &rng, 1e-9));
    assert_true(fabs(ball.radius + 1e-6) < 1e-12);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_start),      cmocka_unit_test(test_random),
        cmocka_unit_test(test_moved_away), cmocka_unit_test(test_moved_nearer),
        cmocka_unit_test(test_degenerate), cmocka_unit_test(test_repeated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
