/* SPDX-License-Identifier: Apache-2.0 */
/* Odd sets of witnesses, which prove more than their witnesses one by one.
 *
 * If rows together hold every witness of a set T, the numbers that they hold of it sum to at least
 * |T|; so the sum of half of each of these numbers, rounded up, is at least half of |T|, rounded up
 * [zero-half cuts: Caprara, Fischetti 1996; of art galleries in the plane: Fekete, Friedrichs,
 * Kroeller, Schmidt 2015]. Three witnesses, any two of which some point sees but no point all
 * three, need two points, where prices of single witnesses prove one and a half. */
#ifndef STARG_GUARD_ODD_SETS_H
#define STARG_GUARD_ODD_SETS_H

#include <string.h>

#include "core/memory.h"
#include "guard/witnesses.h"

enum { MOST_ODD_SETS = 192, ODD_SET_SIZE = 7 };

typedef struct odd_set {
    uint16_t witness[ODD_SET_SIZE]; /* ascending */
    uint16_t count;                 /* odd, 3 or more */
} odd_set;

typedef struct odd_sets {
    size_t count;
    odd_set set[MOST_ODD_SETS];
    uint16_t first[MOST_WITNESSES + 1]; /* by witness: where its sets begin in `of`, and the end */
    uint16_t of[MOST_ODD_SETS * ODD_SET_SIZE];
} odd_sets;

/* Half of the number, rounded up: what all rows of a cover sum to at least. */
static inline unsigned odd_set_need(const odd_set *set) {
    return (set->count + 1U) / 2;
}

/* By set, half of what the row holds of it, rounded up. */
static inline void odd_sets_halves(const odd_sets *sets, const witness_row *row,
                                   uint8_t halves[MOST_ODD_SETS]) {
    memset(halves, 0, sets->count);
    for (size_t w = 0; w < WITNESS_WORDS && sets->count > 0; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            for (size_t k = sets->first[64 * w + bit]; k < sets->first[64 * w + bit + 1]; k++)
                halves[sets->of[k]]++;
    for (size_t k = 0; k < sets->count; k++)
        halves[k] = (uint8_t)((halves[k] + 1) / 2);
}

/* A fractional cover of the witnesses, and the prices that it was found with. */
typedef struct odd_sets_question {
    const witness_row *const *rows;
    const double *share; /* by row */
    size_t count;
    const double *price; /* by witness */
} odd_sets_question;

/* Leaves out the sets without a price, and adds some that the fractional cover holds too little of;
 * `price`, by set, goes along. *added: how many. Errors: MEMORY. */
starg_status odd_sets_renew(starg_context *context, const odd_sets_question *question,
                            odd_sets *sets, double price[MOST_ODD_SETS], size_t *added,
                            uint64_t *work);

#endif
