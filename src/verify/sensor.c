/* SPDX-License-Identifier: Apache-2.0 */
/* q is within the cone exactly if (q - p) . d >= c |q - p| |d|, and likewise for angles between
 * other vectors that are polynomials of coordinates: a normal and a line of sight, two lines from a
 * centroid. Far from the side a rounded comparison is enough. Otherwise the sign of the product is
 * found, and where both sides have the same one, their squares are compared: polynomials, written
 * out in products of up to eight doubles that a long accumulator adds without rounding (as in
 * verify/signs.h, wider). */
#include "verify/sight.h"

#include <math.h>

#include "core/compiler.h"

/* Bit 0 is worth 2^(-8 x 1074); 2^14 products below 2^2680 end below bit 11290. */
enum { FACTORS = 8, WORDS = 178, LOWEST = -1074 };

typedef struct wide_sum {
    uint64_t plus[WORDS], minus[WORDS];
} wide_sum;

/* words += value << (64 x at) */
static void add_word(uint64_t *words, int at, uint64_t value) {
    while (value != 0 && at < WORDS) {
        words[at] += value;
        value = words[at] < value;
        at++;
    }
}

/* product *= factor; as many words as factors are enough for their mantissas */
static void multiply(uint64_t product[FACTORS], uint64_t factor) {
    uint64_t carry = 0;
    for (int i = 0; i < FACTORS; i++) {
        starg_uint128 step = (starg_uint128)product[i] * factor + carry;
        product[i] = (uint64_t)step;
        carry = (uint64_t)(step >> 64);
    }
}

/* sum += sign x the product of the factors */
static void add_product(wide_sum *sum, int sign, const double factors[], int count) {
    uint64_t product[FACTORS] = {1};
    int shift = -FACTORS * LOWEST;
    for (int i = 0; i < count; i++) {
        int exponent;
        double fraction = frexp(factors[i], &exponent);
        if (factors[i] == 0)
            return;
        int drop = exponent - 53 < LOWEST ? LOWEST - (exponent - 53) : 0;
        multiply(product, (uint64_t)ldexp(fabs(fraction), 53 - drop));
        shift += exponent - 53 + drop;
        sign = factors[i] < 0 ? -sign : sign;
    }
    uint64_t *words = sign > 0 ? sum->plus : sum->minus;
    for (int i = 0; i < FACTORS; i++) {
        starg_uint128 moved = (starg_uint128)product[i] << shift % 64;
        add_word(words, shift / 64 + i, (uint64_t)moved);
        add_word(words, shift / 64 + i + 1, (uint64_t)(moved >> 64));
    }
}

static int sign_of(const wide_sum *sum) {
    for (int i = WORDS - 1; i >= 0; i--)
        if (sum->plus[i] != sum->minus[i])
            return sum->plus[i] > sum->minus[i] ? 1 : -1;
    return 0;
}

/* ---- polynomials ---- */

enum { MOST_TERMS = 108, TERM_FACTORS = 4 };

/* A small whole number times some doubles. */
typedef struct term {
    double coefficient;
    int count;
    double factor[TERM_FACTORS];
} term;

typedef struct polynomial {
    int count;
    term terms[MOST_TERMS];
} polynomial;

static void add_term(polynomial *to, double coefficient, const double *factors, int count) {
    term *t = &to->terms[to->count++];
    t->coefficient = coefficient;
    t->count = count;
    memcpy(t->factor, factors, (size_t)count * sizeof *factors);
}

/* to += a b */
static void multiply_into(polynomial *to, const polynomial *a, const polynomial *b) {
    for (int i = 0; i < a->count; i++)
        for (int j = 0; j < b->count; j++) {
            double all[TERM_FACTORS];
            const term *s = &a->terms[i], *t = &b->terms[j];
            memcpy(all, s->factor, (size_t)s->count * sizeof *all);
            memcpy(all + s->count, t->factor, (size_t)t->count * sizeof *all);
            add_term(to, s->coefficient * t->coefficient, all, s->count + t->count);
        }
}

/* sum += sign a b c^2 */
static void add_products_of(wide_sum *sum, int sign, const polynomial *a, const polynomial *b,
                            double c) {
    for (int i = 0; i < a->count; i++)
        for (int j = 0; j < b->count; j++) {
            const term *s = &a->terms[i], *t = &b->terms[j];
            double all[FACTORS + 1], times = s->coefficient * t->coefficient;
            int count = 0;
            if (fabs(times) != 1)
                all[count++] = fabs(times);
            for (int k = 0; k < s->count; k++)
                all[count++] = s->factor[k];
            for (int k = 0; k < t->count; k++)
                all[count++] = t->factor[k];
            for (int k = 0; k < 2 && c != 1; k++)
                all[count++] = c;
            add_product(sum, times < 0 ? -sign : sign, all, count);
        }
}

static int sign_of_polynomial(const polynomial *a) {
    static const polynomial one = {1, {{1, 0, {0}}}};
    wide_sum sum;
    memset(&sum, 0, sizeof sum);
    add_products_of(&sum, 1, a, &one, 1);
    return sign_of(&sum);
}

/* Sign of u . v - c |u| |v|. */
static int compare_angle(const polynomial u[3], const polynomial v[3], double c) {
    polynomial dot = {0}, first = {0}, second = {0};
    for (int k = 0; k < 3; k++) {
        multiply_into(&dot, &u[k], &v[k]);
        multiply_into(&first, &u[k], &u[k]);
        multiply_into(&second, &v[k], &v[k]);
    }
    int left = sign_of_polynomial(&dot), right = (c > 0) - (c < 0);
    if (sign_of_polynomial(&first) == 0 || sign_of_polynomial(&second) == 0)
        right = 0;
    if (left != right || right == 0)
        return left - right;
    wide_sum sum;
    memset(&sum, 0, sizeof sum);
    add_products_of(&sum, 1, &dot, &dot, 1);
    add_products_of(&sum, -1, &first, &second, c);
    return left * sign_of(&sum);
}

/* ---- estimates ---- */

static double length_of(const double v[3]) {
    return hypot(hypot(v[0], v[1]), v[2]);
}

static double dot_of(const double u[3], const double v[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/* Sign of u . v - c |u| |v|, or 0 where it is no more than the doubt. */
static int estimate(const double u[3], const double v[3], double c, double doubt) {
    double size = length_of(u) * length_of(v), excess = dot_of(u, v) - c * size;
    if (!(size > 1e-200) || !(fabs(excess) > doubt + 1e-13 * size))
        return 0;
    return excess > 0 ? 1 : -1;
}

/* ---- the rules ---- */

/* q - p */
static void line_from(polynomial out[3], const double p[3], const double q[3]) {
    for (int k = 0; k < 3; k++) {
        out[k].count = 0;
        add_term(&out[k], 1, &q[k], 1);
        add_term(&out[k], -1, &p[k], 1);
    }
}

static void subtract(double out[3], const double q[3], const double p[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = q[k] - p[k];
}

bool verify_in_cone(const double p[3], const double direction[3], double cosine,
                    const double q[3]) {
    double rounded[3];
    polynomial line[3], axis[3];
    subtract(rounded, q, p);
    int guess = estimate(rounded, direction, cosine, 0);
    if (guess != 0)
        return guess > 0;
    line_from(line, p, q);
    for (int k = 0; k < 3; k++) {
        axis[k].count = 0;
        add_term(&axis[k], 1, &direction[k], 1);
    }
    return compare_angle(line, axis, cosine) >= 0;
}

/* Is q before the plane through p with that normal, or in it? */
static bool is_before(const double p[3], const double normal[3], const double q[3]) {
    polynomial height = {0};
    double rounded[3];
    subtract(rounded, q, p);
    int guess = estimate(rounded, normal, 0, 0);
    if (guess != 0)
        return guess > 0;
    for (int k = 0; k < 3; k++) {
        add_term(&height, 1, (const double[]){normal[k], q[k]}, 2);
        add_term(&height, -1, (const double[]){normal[k], p[k]}, 2);
    }
    return sign_of_polynomial(&height) >= 0;
}

bool verify_is_near(const verify_view *view, const double p[3], double depth, const double q[3]) {
    double at[3], normal[3];
    if (!(depth < 1e100))
        return true;
    starg_depth_plane(p, view->ahead, depth, at, normal);
    return is_before(at, normal, q);
}

bool verify_in_view(const verify_view *view, const double p[3], const double q[3]) {
    if (!verify_within(p, q, view->range))
        return false;
    /* not nearer: at the distance itself, both hold */
    if (view->near > 0 && verify_nearer(p, q, view->near))
        return false;
    if (view->direction != NULL && !verify_in_cone(p, view->direction, view->cosine, q))
        return false;
    for (int side = 0; view->framed && side < 4; side++)
        if (!is_before(p, view->planes[side], q))
            return false;
    return !view->framed || verify_is_near(view, p, view->depth, q);
}

/* The normal towards the inner side: the products of all pairs of corners, clockwise. */
static void inner_normal(polynomial out[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k].count = 0;
        for (int side = 0; side < 3; side++) {
            const double *a = t[side], *b = t[(side + 1) % 3];
            add_term(&out[k], -1, (const double[]){a[i], b[j]}, 2);
            add_term(&out[k], 1, (const double[]){a[j], b[i]}, 2);
        }
    }
}

/* Sign of (n . (p - q))^2 - c^2 |n|^2 |p - q|^2, where n . (p - q) is known to be positive. */
static bool is_steep(const polynomial n[3], const double p[3], const double q[3], double c) {
    polynomial line[3], height = {0}, first = {0}, second = {0};
    line_from(line, q, p);
    wide_sum sum;
    memset(&sum, 0, sizeof sum);
    for (int k = 0; k < 3; k++) {
        multiply_into(&height, &n[k], &line[k]);
        multiply_into(&first, &n[k], &n[k]);
        multiply_into(&second, &line[k], &line[k]);
    }
    add_products_of(&sum, 1, &height, &height, 1);
    add_products_of(&sum, -1, &first, &second, c);
    return sign_of(&sum) >= 0;
}

bool verify_faces(const verify_view *view, const double p[3], const double *const t[3],
                  const double *const corners[3]) {
    double u[3], v[3], rounded[3], line[3];
    if (view->steepest == 0)
        return true;
    subtract(u, t[1], t[0]);
    subtract(v, t[2], t[0]);
    for (int k = 0; k < 3; k++)
        rounded[k] = u[(k + 2) % 3] * v[(k + 1) % 3] - u[(k + 1) % 3] * v[(k + 2) % 3];
    for (int i = 0; i < 3; i++) {
        polynomial normal[3];
        subtract(line, p, corners[i]);
        int guess = estimate(rounded, line, view->steepest,
                             1e-13 * length_of(u) * length_of(v) * length_of(line));
        if (guess < 0)
            return false;
        if (guess > 0)
            continue;
        inner_normal(normal, t);
        if (!is_steep(normal, p, corners[i], view->steepest))
            return false;
    }
    return true;
}

bool verify_apart(const double *const t[3], const double p[3], const double q[3], double cosine) {
    double u[3], v[3], size = 0;
    polynomial lines[2][3];
    const double *ends[2] = {p, q};
    for (int k = 0; k < 3; k++) {
        double sum = t[0][k] + t[1][k] + t[2][k];
        u[k] = 3 * p[k] - sum;
        v[k] = 3 * q[k] - sum;
        size = fmax(size, fabs(t[0][k]) + fabs(t[1][k]) + fabs(t[2][k]));
        size = fmax(size, 3 * fmax(fabs(p[k]), fabs(q[k])));
    }
    int guess = estimate(u, v, cosine, 1e-13 * size * (length_of(u) + length_of(v)));
    if (guess != 0)
        return guess < 0;
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            lines[i][k].count = 0;
            add_term(&lines[i][k], 3, &ends[i][k], 1);
            for (int corner = 0; corner < 3; corner++)
                add_term(&lines[i][k], -1, &t[corner][k], 1);
        }
    return compare_angle(lines[0], lines[1], cosine) <= 0;
}
