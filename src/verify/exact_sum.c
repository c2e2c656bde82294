/* SPDX-License-Identifier: Apache-2.0 */
/* Exact sums of products of three doubles, their signs and values.
 *
 * A long accumulator [Kulisch, Miranker: Computer Arithmetic in Theory and Practice, 1981]: a
 * fixed-point number wide enough for every product of three doubles below 2^361, subnormals
 * included, so that additions are never rounded. One for positive and one for negative products:
 * comparing the two gives the sign. No scaling, no differences, no cases: a polynomial is expanded
 * in its coordinates, term by term. Allocates nothing. */
#include "verify/signs.h"

#include <math.h>
#include <string.h>

#include "core/compiler.h"

enum {
    MANTISSA_BITS = 52,
    EXPONENT_MASK = 0x7ff,
    LOWEST_EXPONENT = -1074 /* of a mantissa taken as an integer */
};

/* A double as mantissa x 2^exponent, with a separate sign. */
typedef struct parts {
    uint64_t mantissa;
    int exponent;
    bool negative;
} parts;

static parts take_apart(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int field = (int)(bits >> MANTISSA_BITS) & EXPONENT_MASK;
    uint64_t fraction = bits & (((uint64_t)1 << MANTISSA_BITS) - 1);
    bool normal = field != 0;
    return (parts){.mantissa = fraction | (uint64_t)normal << MANTISSA_BITS,
                   .exponent = LOWEST_EXPONENT + field - normal,
                   .negative = bits >> 63};
}

void exact_sum_clear(exact_sum *sum) {
    memset(sum, 0, sizeof *sum);
}

/* words += value << (64 x at), with carry propagation. */
static void add_at(uint64_t *words, int at, starg_uint128 value) {
    for (; value != 0 && at < EXACT_SUM_WORDS; at++) {
        starg_uint128 total = (starg_uint128)words[at] + (uint64_t)value;
        words[at] = (uint64_t)total;
        value = (value >> 64) + (uint64_t)(total >> 64);
    }
}

void exact_sum_add(exact_sum *sum, double a, double b, double c) {
    parts x = take_apart(a), y = take_apart(b), z = take_apart(c);
    uint64_t *words = x.negative ^ y.negative ^ z.negative ? sum->minus : sum->plus;
    int shift = x.exponent + y.exponent + z.exponent - 3 * LOWEST_EXPONENT;
    int at = shift / 64, bits = shift % 64;

    /* 53 x 53 x 53 bits: the product of two factors in two words, each times the third */
    starg_uint128 two = (starg_uint128)x.mantissa * y.mantissa;
    starg_uint128 product[2] = {(starg_uint128)(uint64_t)two * z.mantissa,
                                (two >> 64) * z.mantissa};
    for (int i = 0; i < 2; i++) { /* at most 117 bits each; shifted left by words and bits */
        starg_uint128 low = (starg_uint128)(uint64_t)product[i] << bits;
        starg_uint128 high = (product[i] >> 64) << bits;
        add_at(words, at + i, low);
        add_at(words, at + i + 1, high);
    }
}

void exact_sum_add_determinant(exact_sum *sum, const double a[3], const double b[3],
                               const double c[3]) {
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        exact_sum_add(sum, a[k], b[u], c[v]);
        exact_sum_add(sum, -a[k], b[v], c[u]);
    }
}

void exact_sum_add_sum(exact_sum *sum, const exact_sum *other) {
    for (int i = 0; i < EXACT_SUM_WORDS; i++) {
        add_at(sum->plus, i, other->plus[i]);
        add_at(sum->minus, i, other->minus[i]);
    }
}

int exact_sum_sign(const exact_sum *sum) {
    for (int i = EXACT_SUM_WORDS - 1; i >= 0; i--)
        if (sum->plus[i] != sum->minus[i])
            return sum->plus[i] > sum->minus[i] ? 1 : -1;
    return 0;
}

double exact_sum_value(const exact_sum *sum, int scale) {
    int sign = exact_sum_sign(sum);
    const uint64_t *large = sign < 0 ? sum->minus : sum->plus;
    const uint64_t *small = sign < 0 ? sum->plus : sum->minus;
    uint64_t rest[EXACT_SUM_WORDS];
    uint64_t borrow = 0;
    double value = 0;
    for (int i = 0; i < EXACT_SUM_WORDS; i++) {
        starg_uint128 less = (starg_uint128)small[i] + borrow;
        rest[i] = large[i] - (uint64_t)less;
        borrow = large[i] < less;
    }
    for (int i = EXACT_SUM_WORDS - 1, used = 0; i >= 0 && used < 3; i--) {
        used += used > 0 || rest[i] != 0;
        value += ldexp((double)rest[i], 64 * i + 3 * LOWEST_EXPONENT + scale);
    }
    return sign * value;
}
