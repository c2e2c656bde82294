/* SPDX-License-Identifier: Apache-2.0 */
#include "geometry/exact.h"

#include <stdbool.h>
#include <string.h>

#include "core/compiler.h"

/* A double as mantissa x 2^exponent with an odd mantissa; false for zero. */
static bool split(double value, uint64_t *mantissa, int *exponent) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    int biased = (int)(bits >> 52) & 0x7ff;
    uint64_t m = bits & ((UINT64_C(1) << 52) - 1);
    int e = -1074;
    if (biased != 0) {
        m |= UINT64_C(1) << 52;
        e = biased - 1075;
    }
    if (m == 0)
        return false;
    int zeros = __builtin_ctzll(m);
    *mantissa = m >> zeros;
    *exponent = e + zeros;
    return true;
}

int exact_scale(const double *values, size_t count, int *bits) {
    int lowest = 2000, highest = -2000;
    for (size_t i = 0; i < count; i++) {
        uint64_t mantissa;
        int exponent;
        if (!split(values[i], &mantissa, &exponent))
            continue;
        int top = exponent + 64 - __builtin_clzll(mantissa);
        if (exponent < lowest)
            lowest = exponent;
        if (top > highest)
            highest = top;
    }
    *bits = lowest > highest ? 0 : highest - lowest;
    return lowest > highest ? 0 : lowest;
}

void exact_set(exact *out, double value, int scale) {
    uint64_t mantissa;
    int exponent;
    if (!split(value, &mantissa, &exponent)) {
        out->sign = out->count = 0;
        return;
    }
    int shift = exponent - scale, word = shift / 64, bit = shift % 64;
    memset(out->limb, 0, (size_t)word * sizeof *out->limb);
    out->limb[word] = mantissa << bit;
    out->count = word + 1;
    if (bit != 0 && mantissa >> (64 - bit) != 0)
        out->limb[out->count++] = mantissa >> (64 - bit);
    out->sign = value < 0 ? -1 : 1;
}

int64_t exact_small(double value, int scale) {
    uint64_t mantissa;
    int exponent;
    if (!split(value, &mantissa, &exponent))
        return 0;
    int64_t magnitude = (int64_t)(mantissa << (exponent - scale));
    return value < 0 ? -magnitude : magnitude;
}

static int compare_magnitude(const exact *a, const exact *b) {
    if (a->count != b->count)
        return a->count < b->count ? -1 : 1;
    for (int i = a->count - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

/* |out| = |a| + |b|, where a has at least as many limbs as b. */
static void add_magnitude(exact *out, const exact *a, const exact *b) {
    starg_uint128 carry = 0;
    for (int i = 0; i < a->count; i++) {
        carry += a->limb[i];
        if (i < b->count)
            carry += b->limb[i];
        out->limb[i] = (uint64_t)carry;
        carry >>= 64;
    }
    out->count = a->count;
    if (carry != 0)
        out->limb[out->count++] = (uint64_t)carry;
}

/* |out| = |a| - |b| with |a| > |b|. */
static void subtract_magnitude(exact *out, const exact *a, const exact *b) {
    uint64_t borrow = 0;
    for (int i = 0; i < a->count; i++) {
        uint64_t subtrahend = i < b->count ? b->limb[i] : 0;
        uint64_t difference = a->limb[i] - subtrahend;
        uint64_t next = a->limb[i] < subtrahend || difference < borrow;
        out->limb[i] = difference - borrow;
        borrow = next;
    }
    out->count = a->count;
    while (out->count > 0 && out->limb[out->count - 1] == 0)
        out->count--;
}

static void copy(exact *out, const exact *a, int sign) {
    out->sign = sign;
    out->count = a->count;
    memcpy(out->limb, a->limb, (size_t)a->count * sizeof *a->limb);
}

static void add_signed(exact *out, const exact *a, const exact *b, int b_sign) {
    if (b_sign == 0) {
        copy(out, a, a->sign);
    } else if (a->sign == 0) {
        copy(out, b, b_sign);
    } else if (a->sign == b_sign) {
        out->sign = b_sign;
        if (a->count >= b->count)
            add_magnitude(out, a, b);
        else
            add_magnitude(out, b, a);
    } else {
        int order = compare_magnitude(a, b);
        out->sign = order == 0 ? 0 : order > 0 ? a->sign : b_sign;
        out->count = 0;
        if (order > 0)
            subtract_magnitude(out, a, b);
        else if (order < 0)
            subtract_magnitude(out, b, a);
    }
}

void exact_add(exact *out, const exact *a, const exact *b) {
    add_signed(out, a, b, b->sign);
}

void exact_subtract(exact *out, const exact *a, const exact *b) {
    add_signed(out, a, b, -b->sign);
}

void exact_multiply(exact *out, const exact *a, const exact *b) {
    out->sign = a->sign * b->sign;
    if (out->sign == 0) {
        out->count = 0;
        return;
    }
    memset(out->limb, 0, (size_t)(a->count + b->count) * sizeof *out->limb);
    for (int i = 0; i < a->count; i++) {
        starg_uint128 carry = 0;
        for (int j = 0; j < b->count; j++) {
            carry += (starg_uint128)a->limb[i] * b->limb[j] + out->limb[i + j];
            out->limb[i + j] = (uint64_t)carry;
            carry >>= 64;
        }
        out->limb[i + b->count] = (uint64_t)carry;
    }
    out->count = a->count + b->count;
    if (out->limb[out->count - 1] == 0)
        out->count--;
}

void exact_minor(exact *out, const exact *a, const exact *b, const exact *c, const exact *d) {
    exact ab, cd;
    exact_multiply(&ab, a, b);
    exact_multiply(&cd, c, d);
    exact_subtract(out, &ab, &cd);
}

void exact_determinant(exact *out, const exact a[3], const exact b[3], const exact c[3]) {
    exact minor, term[3], sum;
    exact_minor(&minor, &b[0], &c[1], &c[0], &b[1]);
    exact_multiply(&term[0], &a[2], &minor);
    exact_minor(&minor, &c[0], &a[1], &a[0], &c[1]);
    exact_multiply(&term[1], &b[2], &minor);
    exact_minor(&minor, &a[0], &b[1], &b[0], &a[1]);
    exact_multiply(&term[2], &c[2], &minor);
    exact_add(&sum, &term[0], &term[1]);
    exact_add(out, &sum, &term[2]);
}
