/* SPDX-License-Identifier: Apache-2.0 */
/* Integers of many limbs, for signs that floating point cannot decide.
 *
 * Every finite double is an integer times a power of two. A predicate's inputs are brought to the
 * common power (exact_scale), so that its polynomial becomes one of integers, whose sign is the
 * answer: no overflow, no underflow, no tolerance. Trailing zero bits go into the common power,
 * so that lattice-like coordinates stay short. Lives on the stack; allocates nothing. */
#ifndef STARG_GEOMETRY_EXACT_H
#define STARG_GEOMETRY_EXACT_H

#include <stddef.h>
#include <stdint.h>

/* Doubles below 1e100 need at most 333 + 1074 bits above the smallest subnormal: 23 limbs for a
 * difference, 117 for the in-sphere determinant, which has degree five, 138 for the squares that
 * tell how obliquely a point sees a triangle, which have degree six, with a cosine of at most 53 +
 * 64 bits. */
enum { EXACT_LIMBS = 144 };

/* sign is -1, 0 or 1; limb[0 .. count - 1] is the magnitude, lowest first, no leading zeros. */
typedef struct exact {
    int sign, count;
    uint64_t limb[EXACT_LIMBS];
} exact;

/* The largest e with all values multiples of 2^e (0 when all are zero), and how many bits the
 * largest of them then has. */
int exact_scale(const double *values, size_t count, int *bits);

/* out = value / 2^scale, for a scale of exact_scale. */
void exact_set(exact *out, double value, int scale);
/* The same where it fits an int64_t. */
int64_t exact_small(double value, int scale);

/* Results may not be an operand. */
void exact_add(exact *out, const exact *a, const exact *b);
void exact_subtract(exact *out, const exact *a, const exact *b);
void exact_multiply(exact *out, const exact *a, const exact *b);

/* out = a b - c d */
void exact_minor(exact *out, const exact *a, const exact *b, const exact *c, const exact *d);
/* out = the determinant of three rows, by its third column as the filters do. */
void exact_determinant(exact *out, const exact a[3], const exact b[3], const exact c[3]);

#endif
