/* SPDX-License-Identifier: Apache-2.0 */
/* Randomized incremental linear programming.
 *
 * Problem: maximize a linear function over n half-spaces and a ball, in d <= 4 variables.
 * Source: R. Seidel, Small-dimensional linear programming and convex hulls made easy, 1991; rows
 * that become tight move to the front as in E. Welzl, Smallest enclosing disks (balls and
 * ellipsoids), 1991.
 *
 * Stages: shuffle the rows, those of an earlier solution first; start from the best point of the
 * ball; add row by row: a satisfied row changes nothing, a violated row is tight in the new
 * solution, which is found on its plane among the earlier rows, one dimension lower. On a line, the
 * rows leave an interval.
 *
 * A lower-dimensional plane is a point and an orthonormal basis of R^d, not a set of eliminated
 * coordinates: every level uses the original rows, and errors do not grow with depth. A ball rather
 * than a box, because its best point on a plane has a closed form.
 *
 * Invariants: after i rows the point solves the first i rows of `order` (rounded); recursion
 * permutes only those. If rows are infeasible, so are the violated rows on the way down together
 * with the two that leave no interval: the point before satisfied all others and violated that row,
 * and the intersection of the others is convex.
 *
 * Cost: expected O(d! n); O(n) if `start` is right. */
#include "geometry/linear_program.h"

#include <string.h>

#include "core/rng.h"

enum { MOST = LINEAR_PROGRAM_MOST };

static const uint32_t NO_ROW = UINT32_MAX;
static const double SLACK = 0x1p-46;    /* relative to the radius: smaller violations are ignored */
static const double PARALLEL = 0x1p-42; /* directions with a smaller cosine are parallel to a row */

/* Affine subspace: point + span of the first `dimension` basis vectors. */
typedef struct flat {
    int dimension;
    double point[MOST];
    double basis[MOST][MOST];
} flat;

typedef struct solver {
    const linear_program *program;
    uint32_t *order;
    double slack;
} solver;

static double dot(const double *a, const double *b, int count) {
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += a[k] * b[k];
    return sum;
}

static const double *row_at(const linear_program *program, uint32_t row) {
    return program->rows + (size_t)(program->dimension + 1) * row;
}

/* How far a point lies beyond a row. */
static double excess(const linear_program *program, uint32_t row, const double *point) {
    const double *a = row_at(program, row);
    return dot(a, point, program->dimension) - a[program->dimension];
}

/* The order in which rows are added. */
static void shuffle(const linear_program *program, uint32_t *order) {
    starg_rng rng = starg_rng_make(program->seed, program->count, 0);
    for (size_t i = 0; i < program->count; i++) {
        size_t j = starg_rng_below(&rng, i + 1);
        order[i] = order[j];
        order[j] = (uint32_t)i;
    }
}

static void move_to_front(uint32_t *order, size_t i) {
    uint32_t row = order[i];
    memmove(order + 1, order, i * sizeof *order);
    order[0] = row;
}

static void start_with(const linear_program *program, uint32_t *order,
                       const linear_solution *start) {
    for (int k = 0; k < start->tight_count; k++)
        for (size_t i = 0; i < program->count; i++)
            if (order[i] == start->tight[k]) {
                move_to_front(order, i);
                break;
            }
}

/* The ball's intersection with a flat: centre, and radius or a negative number if empty. */
static double ball_on(const linear_program *program, const flat *f, double center[MOST]) {
    int n = program->dimension;
    double offset[MOST], distance = 0;
    for (int k = 0; k < n; k++) {
        offset[k] = program->center[k] - f->point[k];
        center[k] = f->point[k];
    }
    for (int i = 0; i < f->dimension; i++) {
        double t = dot(f->basis[i], offset, n);
        for (int k = 0; k < n; k++)
            center[k] += t * f->basis[i][k];
    }
    for (int k = 0; k < n; k++)
        distance += (program->center[k] - center[k]) * (program->center[k] - center[k]);
    double square = program->radius * program->radius - distance;
    return square < 0 ? -1 : sqrt(square);
}

/* Components of a direction along a flat's basis; returns their length. */
static double project(const linear_program *program, const flat *f, const double *direction,
                      double out[MOST]) {
    for (int i = 0; i < f->dimension; i++)
        out[i] = dot(f->basis[i], direction, program->dimension);
    return sqrt(dot(out, out, f->dimension));
}

/* out = point + sum of factor * along[i] * basis[i] */
static void advance(const linear_program *program, const flat *f, const double *point,
                    double factor, const double *along, double *out) {
    for (int k = 0; k < program->dimension; k++) {
        double x = point[k];
        for (int i = 0; i < f->dimension; i++)
            x += factor * along[i] * f->basis[i][k];
        out[k] = x;
    }
}

/* The best point of the ball on a flat; its centre when all are equally good. */
static bool best_of_ball(const solver *s, const flat *f, double point[MOST]) {
    double center[MOST], along[MOST];
    double radius = ball_on(s->program, f, center);
    if (radius < 0)
        return false;
    double length = project(s->program, f, s->program->objective, along);
    advance(s->program, f, center, length > PARALLEL ? radius / length : 0, along, point);
    return true;
}

/* The intersection of a flat with a row's plane; false if parallel. Householder's reflection maps
 * the row's direction to the first basis vector, which is dropped. */
static bool cut(const solver *s, const flat *f, uint32_t row, const double *point, flat *out) {
    const linear_program *program = s->program;
    double g[MOST] = {0};
    double length = project(program, f, row_at(program, row), g);
    if (length <= PARALLEL)
        return false;
    advance(program, f, point, -excess(program, row, point) / (length * length), g, out->point);
    for (int i = 0; i < f->dimension; i++)
        g[i] /= length;
    g[0] += g[0] < 0 ? -1 : 1;
    double scale = 2 / dot(g, g, f->dimension);
    for (int j = 1; j < f->dimension; j++)
        for (int k = 0; k < program->dimension; k++) {
            double x = f->basis[j][k];
            for (int i = 0; i < f->dimension; i++)
                x -= scale * g[j] * g[i] * f->basis[i][k];
            out->basis[j - 1][k] = x;
        }
    out->dimension = f->dimension - 1;
    return true;
}

/* What the rows leave of a line. */
typedef struct interval {
    double low, high;
    uint32_t low_row, high_row; /* NO_ROW: the ball */
} interval;

static void add_tight(linear_solution *out, uint32_t row) {
    if (row != NO_ROW)
        out->tight[out->tight_count++] = row;
}

/* False if a parallel row excludes the whole line. */
static bool clip(const solver *s, const flat *f, uint32_t row, interval *left) {
    const double *a = row_at(s->program, row);
    double slope = dot(a, f->basis[0], s->program->dimension);
    double gap = -excess(s->program, row, f->point);
    if (fabs(slope) <= PARALLEL)
        return gap >= -4 * s->slack;
    double t = gap / slope;
    if (slope > 0 && t < left->high) {
        left->high = t;
        left->high_row = row;
    } else if (slope < 0 && t > left->low) {
        left->low = t;
        left->low_row = row;
    }
    return true;
}

/* If the ends passed one another by rounding only, the interval is a point. */
static bool is_empty(const solver *s, const interval *left, const double *middle) {
    if (left->low <= left->high)
        return false;
    if (left->low_row == NO_ROW || left->high_row == NO_ROW)
        return true;
    return excess(s->program, left->low_row, middle) > 4 * s->slack ||
           excess(s->program, left->high_row, middle) > 4 * s->slack;
}

static bool solve_on_line(const solver *s, const flat *f, size_t count, linear_solution *out) {
    const linear_program *program = s->program;
    flat line = *f;
    double radius = ball_on(program, f, line.point);
    if (radius < 0)
        return false;
    interval left = {-radius, radius, NO_ROW, NO_ROW};
    for (size_t i = 0; i < count; i++)
        if (!clip(s, &line, s->order[i], &left)) {
            add_tight(out, s->order[i]);
            return false;
        }
    double one = 1, slope = dot(program->objective, line.basis[0], program->dimension);
    double middle = 0.5 * (left.low + left.high);
    advance(program, &line, line.point, middle, &one, out->point);
    if (is_empty(s, &left, out->point)) {
        add_tight(out, left.low_row);
        add_tight(out, left.high_row);
        return false;
    }
    if (fabs(slope) <= PARALLEL)
        return true;
    if (left.low < left.high)
        advance(program, &line, line.point, slope > 0 ? left.high : left.low, &one, out->point);
    add_tight(out, slope > 0 ? left.high_row : left.low_row);
    return true;
}

/* Solves for the first `count` rows of the order on a flat. */
static bool solve_on(const solver *s, const flat *f, size_t count, linear_solution *out) {
    out->tight_count = 0;
    if (f->dimension == 1)
        return solve_on_line(s, f, count, out);
    if (!best_of_ball(s, f, out->point))
        return false;
    for (size_t i = 0; i < count; i++) {
        uint32_t row = s->order[i];
        if (excess(s->program, row, out->point) <= s->slack)
            continue;
        flat plane;
        bool met = cut(s, f, row, out->point, &plane);
        out->tight_count = 0;
        bool feasible = met && solve_on(s, &plane, i, out);
        add_tight(out, row);
        if (!feasible)
            return false;
        move_to_front(s->order, i);
    }
    return true;
}

void linear_program_solve(const linear_program *program, uint32_t *order,
                          const linear_solution *start, linear_solution *solution) {
    const solver s = {program, order, SLACK * program->radius};
    flat whole = {.dimension = program->dimension};
    for (int k = 0; k < program->dimension; k++) {
        whole.point[k] = program->center[k];
        whole.basis[k][k] = 1;
    }
    shuffle(program, order);
    if (start != NULL)
        start_with(program, order, start);
    *solution = (linear_solution){.feasible = false};
    solution->feasible = solve_on(&s, &whole, program->count, solution);
}
