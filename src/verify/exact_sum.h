/* SPDX-License-Identifier: Apache-2.0 */
/* Exact sums of products of three doubles, their signs and values.
 *
 * A long accumulator [Kulisch, Miranker: Computer Arithmetic in Theory and Practice, 1981]: a
 * fixed-point number wide enough for every product of three doubles below 2^340, subnormals
 * included, so that additions are never rounded. One for positive and one for negative products:
 * comparing the two gives the sign. No scaling, no differences, no cases: a polynomial is expanded
 * in its coordinates, term by term. Allocates nothing. */
#ifndef STARG_VERIFY_EXACT_SUM_H
#define STARG_VERIFY_EXACT_SUM_H

#include <stdint.h>

/* Bit 0 is worth 2^(-3 x 1074); 2^32 products below 2^1020 need 3222 + 1052 bits. */
enum { EXACT_SUM_WORDS = 68 };

typedef struct exact_sum {
    uint64_t plus[EXACT_SUM_WORDS], minus[EXACT_SUM_WORDS];
} exact_sum;

void exact_sum_clear(exact_sum *sum);

/* sum += a b c, for finite factors below 2^340 in magnitude. */
void exact_sum_add(exact_sum *sum, double a, double b, double c);

/* sum += det(a, b, c), six products. */
void exact_sum_add_determinant(exact_sum *sum, const double a[3], const double b[3],
                               const double c[3]);

/* sum += other */
void exact_sum_add_sum(exact_sum *sum, const exact_sum *other);

/* -1, 0 or 1. */
int exact_sum_sign(const exact_sum *sum);

/* The sum times 2^scale, rounded: off by less than 2^-52 of it. */
double exact_sum_value(const exact_sum *sum, int scale);

#endif
