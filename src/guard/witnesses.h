/* SPDX-License-Identifier: Apache-2.0 */
/* Rows of bits over the witnesses of a search: faces (or vertices) that represent all of them. */
#ifndef STARG_GUARD_WITNESSES_H
#define STARG_GUARD_WITNESSES_H

#include "core/bits.h"

enum { MOST_WITNESSES = 2048, WITNESS_WORDS = MOST_WITNESSES / 64 };

typedef struct witness_row {
    uint64_t bits[WITNESS_WORDS];
} witness_row;

/* Is every witness of `a` in `b`? */
static inline bool row_is_within(const witness_row *a, const witness_row *b) {
    uint64_t outside = 0;
    for (int w = 0; w < WITNESS_WORDS; w++)
        outside |= a->bits[w] & ~b->bits[w];
    return outside == 0;
}

/* Of those in `among`? */
static inline bool row_is_within_among(const witness_row *a, const witness_row *b,
                                       const witness_row *among) {
    uint64_t outside = 0;
    for (int w = 0; w < WITNESS_WORDS; w++)
        outside |= a->bits[w] & among->bits[w] & ~b->bits[w];
    return outside == 0;
}

static inline double row_value(const witness_row *row, const double *prices) {
    double sum = 0;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            sum += prices[64 * w + bit];
    return sum;
}

#endif
