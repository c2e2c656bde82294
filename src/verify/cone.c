/* SPDX-License-Identifier: Apache-2.0 */
/* q is within the cone exactly if (q - p) . d >= c |q - p| |d|. Far from the side a rounded
 * comparison is enough. Otherwise the sign of (q - p) . d is found, and where both sides have the
 * same one, their squares are compared: polynomials, written out in products of up to six doubles
 * that a long accumulator adds without rounding (as in verify/exact_sum.h, wider). */
#include "verify/cone.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "core/int128.h"
#include "verify/exact_sum.h"

/* Bit 0 is worth 2^(-6 x 1074); 100 products below 2^2004 end below bit 8460. */
enum { FACTORS = 6, WORDS = 134, LOWEST = -1074 };

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

/* product *= factor; six words are enough for six mantissas */
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

/* ((q - p) . d)^2 */
static void add_projection(wide_sum *sum, const double p[3], const double d[3], const double q[3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            add_product(sum, 1, (const double[]){q[i], d[i], q[j], d[j]}, 4);
            add_product(sum, -1, (const double[]){q[i], d[i], p[j], d[j]}, 4);
            add_product(sum, -1, (const double[]){p[i], d[i], q[j], d[j]}, 4);
            add_product(sum, 1, (const double[]){p[i], d[i], p[j], d[j]}, 4);
        }
}

/* - c^2 |q - p|^2 |d|^2 */
static void subtract_lengths(wide_sum *sum, const double p[3], const double d[3], double c,
                             const double q[3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            add_product(sum, -1, (const double[]){c, c, q[i], q[i], d[k], d[k]}, 6);
            add_product(sum, 1, (const double[]){c, c, q[i], p[i], d[k], d[k]}, 6);
            add_product(sum, 1, (const double[]){c, c, q[i], p[i], d[k], d[k]}, 6);
            add_product(sum, -1, (const double[]){c, c, p[i], p[i], d[k], d[k]}, 6);
        }
}

static int sign_of_projection(const double p[3], const double d[3], const double q[3]) {
    exact_sum sum;
    exact_sum_clear(&sum);
    for (int k = 0; k < 3; k++) {
        exact_sum_add(&sum, q[k], d[k], 1);
        exact_sum_add(&sum, -p[k], d[k], 1);
    }
    return exact_sum_sign(&sum);
}

/* 1 and -1 where rounding cannot matter, else 0. */
static int estimate(const double p[3], const double d[3], double cosine, const double q[3]) {
    double along = 0, far = 0, axis = 0;
    for (int k = 0; k < 3; k++) {
        along += (q[k] - p[k]) * d[k];
        far = hypot(far, q[k] - p[k]);
        axis = hypot(axis, d[k]);
    }
    double excess = along - cosine * far * axis, doubt = 1e-13 * far * axis;
    if (!(far * axis > 1e-200) || fabs(excess) <= doubt)
        return 0;
    return excess > 0 ? 1 : -1;
}

bool verify_in_cone(const double p[3], const double direction[3], double cosine,
                    const double q[3]) {
    int guess = estimate(p, direction, cosine, q);
    if (guess != 0)
        return guess > 0;
    if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
        return true;
    int left = sign_of_projection(p, direction, q), right = (cosine > 0) - (cosine < 0);
    if (left != right)
        return left > right;
    wide_sum sum;
    memset(&sum, 0, sizeof sum);
    add_projection(&sum, p, direction, q);
    subtract_lengths(&sum, p, direction, cosine, q);
    return left * sign_of(&sum) >= 0;
}
