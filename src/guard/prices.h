/* SPDX-License-Identifier: Apache-2.0 */
/* The fractional cover of witnesses by rows, and its dual prices. */
#ifndef STARG_GUARD_PRICES_H
#define STARG_GUARD_PRICES_H

#include "guard/odd_sets.h"

typedef struct witness_prices {
    double price[MOST_WITNESSES]; /* no row's sum exceeds 1; 0 if not requested */
    double odd[MOST_ODD_SETS];    /* of half of an odd set: of each half that a row holds */
    double sum;                   /* of the prices: a lower bound on every cover */
    double *share;                /* by row: its value in a fractional cover */
    uint64_t work;                /* in units of about a microsecond */
} witness_prices;

/* Prices of the witnesses in `wanted` and of the odd sets (NULL: none) with maximal sum (up to a
 * thousandth); some row holds each of these witnesses, and each one of the sets. Errors: MEMORY. */
starg_status prices_find(starg_context *context, const witness_row *const *rows, size_t count,
                         const witness_row *wanted, const odd_sets *sets, witness_prices *out);

/* What the row holds is worth. */
static inline double prices_of_row(const witness_prices *prices, const odd_sets *sets,
                                   const witness_row *row) {
    uint8_t halves[MOST_ODD_SETS];
    double sum = row_value(row, prices->price);
    odd_sets_halves(sets, row, halves);
    for (size_t k = 0; k < sets->count; k++)
        sum += halves[k] * prices->odd[k];
    return sum;
}
void prices_free(witness_prices *prices);

#endif
