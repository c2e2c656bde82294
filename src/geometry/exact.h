/* SPDX-License-Identifier: Apache-2.0 */
/* Multi-limb integers, for signs that floating point cannot decide.
 *
 * Every finite double is an integer times a power of two. A predicate scales its inputs to a common
 * power (exact_scale) and evaluates its polynomial in integers: no overflow, no underflow, no
 * tolerance. Common trailing zero bits are divided out, so that lattice-like coordinates stay
 * short. Lives on the stack; allocates nothing. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Doubles below 1e100 need at most 333 + 1074 bits above the smallest subnormal: 23 limbs for a
 * difference, 117 for the in-sphere determinant, which has degree five, 168 for the squares that
 * tell how obliquely a point sees a triangle, which have degree six, with a cosine of any size: 17
 * limbs, twice. */
enum { EXACT_LIMBS = 176 };

/* sign is -1, 0 or 1; limb[0 .. count - 1] is the magnitude, lowest first, no leading zeros. */
typedef struct exact {
    int sign, count;
    uint64_t limb[EXACT_LIMBS];
} exact;

/* The largest e such that all values are multiples of 2^e (0 if all are zero), and the bit length
 * of the largest value in that unit. */
int exact_scale(const double *values, size_t count, int *bits);

/* out = value / 2^scale, for a scale from exact_scale. */
void exact_set(exact *out, double value, int scale);
/* Same, if it fits an int64_t. */
int64_t exact_small(double value, int scale);

/* `out` must not alias an operand. */
void exact_add(exact *out, const exact *a, const exact *b);
void exact_subtract(exact *out, const exact *a, const exact *b);
void exact_multiply(exact *out, const exact *a, const exact *b);

/* out = a b - c d */
void exact_minor(exact *out, const exact *a, const exact *b, const exact *c, const exact *d);
/* out = determinant of three rows, expanded along the third column as in the filters. */
void exact_determinant(exact *out, const exact a[3], const exact b[3], const exact c[3]);
