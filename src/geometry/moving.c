/* SPDX-License-Identifier: Apache-2.0 */
/* Does a tetrahedron stay positive while its corners move on straight lines?
 *
 * The determinant of the edges from one corner is a cubic polynomial in time. Its Bernstein
 * coefficients over [0, 1], times 3, are sums of determinants with rows from the start and from the
 * end; if all are positive, so is the polynomial. Otherwise the interval is halved [de Casteljau],
 * which multiplies all numbers by 8 and so stays in integers. A value at an end of an interval that
 * is not positive refutes; so does the depth limit, which is reached only where the polynomial
 * comes within about 4^-DEPTH of zero, relative to its coefficients.
 *
 * A floating-point filter with a bound on its error accepts what is clear; multi-limb integers
 * decide the rest. Bound: a triple product of differences has the error of orient3d (8 u times its
 * permanent, geometry/predicates.c); a sum of three adds 2 u. */
#include "geometry/predicates.h"

#include <math.h>

#include "geometry/exact.h"

enum { DEPTH = 24 };
static const double BOUND = 12 * 0x1p-53, LEAST = 1e-200;

/* ---- filter ---- */

/* A triple product; adds its permanent. */
static double product(const double a[3], const double b[3], const double c[3], double *permanent) {
    double x = b[1] * c[2], y = b[2] * c[1], z = b[2] * c[0];
    double u = b[0] * c[2], v = b[0] * c[1], w = b[1] * c[0];
    *permanent += fabs(a[0]) * (fabs(x) + fabs(y)) + fabs(a[1]) * (fabs(z) + fabs(u)) +
                  fabs(a[2]) * (fabs(v) + fabs(w));
    return a[0] * (x - y) + a[1] * (z - u) + a[2] * (v - w);
}

/* Where the row comes from in term `own` of the coefficient with `late` rows from the end. */
static int end_of(int late, int own, int row) {
    if (late == 0 || late == 3)
        return late == 3;
    return (row == own) == (late == 1);
}

/* Is the sum of the determinants with `late` rows from the end clearly positive? */
static bool clearly_positive(double edges[2][3][3], int late) {
    double sum = 0, permanent = 0;
    for (int own = 0; own < 3; own++) {
        const double *row[3];
        for (int i = 0; i < 3; i++)
            row[i] = edges[end_of(late, own, i)][i];
        sum += product(row[0], row[1], row[2], &permanent);
    }
    return permanent > LEAST && sum > BOUND * permanent;
}

static bool all_clear(const double *const from[4], const double *const to[4]) {
    double edges[2][3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            edges[0][i][k] = from[i + 1][k] - from[0][k];
            edges[1][i][k] = to[i + 1][k] - to[0][k];
        }
    for (int late = 0; late < 4; late++)
        if (!clearly_positive(edges, late))
            return false;
    return true;
}

/* ---- integers ---- */

/* Edges of both places in one unit. */
static void set_edges(const double *const from[4], const double *const to[4], exact out[2][3][3]) {
    double values[24];
    int bits;
    for (int i = 0; i < 24; i++)
        values[i] = (i < 12 ? from : to)[i / 3 % 4][i % 3];
    int scale = exact_scale(values, 24, &bits);
    for (int end = 0; end < 2; end++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                exact p, q;
                exact_set(&p, values[12 * end + 3 * (i + 1) + k], scale);
                exact_set(&q, values[12 * end + k], scale);
                exact_subtract(&out[end][i][k], &p, &q);
            }
}

/* *sum += value */
static void increase(exact *sum, const exact *value) {
    exact before = *sum;
    exact_add(sum, &before, value);
}

/* Three times the Bernstein coefficients. */
static void set_coefficients(exact edges[2][3][3], exact out[4]) {
    for (int late = 0; late < 4; late++) {
        out[late] = (exact){0};
        for (int own = 0; own < 3; own++) {
            exact determinant;
            const exact *row[3];
            for (int i = 0; i < 3; i++)
                row[i] = edges[end_of(late, own, i)][i];
            exact_determinant(&determinant, row[0], row[1], row[2]);
            increase(&out[late], &determinant);
        }
    }
}

/* The sum of the coefficients in the inner triangle of de Casteljau's scheme, times 8: the first
 * `count` + 1 from `first` on, with binomial weights, times 2^(3 - count). */
static void blend(const exact c[4], int first, int count, exact *out) {
    static const int WEIGHTS[4][4] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}};
    *out = (exact){0};
    for (int i = 0; i <= count; i++)
        for (int times = WEIGHTS[count][i] << (3 - count); times > 0; times--)
            increase(out, &c[first + i]);
}

static bool is_positive(const exact c[4], int depth) {
    if (c[0].sign <= 0 || c[3].sign <= 0)
        return false;
    if (c[1].sign > 0 && c[2].sign > 0)
        return true;
    if (depth == 0)
        return false;
    exact half[4];
    for (int i = 0; i < 4; i++)
        blend(c, 0, i, &half[i]);
    if (!is_positive(half, depth - 1))
        return false;
    for (int i = 0; i < 4; i++)
        blend(c, i, 3 - i, &half[i]);
    return is_positive(half, depth - 1);
}

bool stays_positive(const double *const from[4], const double *const to[4]) {
    if (all_clear(from, to))
        return true;
    exact edges[2][3][3], coefficients[4];
    set_edges(from, to, edges);
    set_coefficients(edges, coefficients);
    return is_positive(coefficients, DEPTH);
}
