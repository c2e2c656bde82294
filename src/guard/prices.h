/* SPDX-License-Identifier: Apache-2.0 */
/* The fractional cover of witnesses by rows, and its dual prices. */
#ifndef STARG_GUARD_PRICES_H
#define STARG_GUARD_PRICES_H

#include "core/memory.h"
#include "guard/witnesses.h"

typedef struct witness_prices {
    double price[MOST_WITNESSES]; /* no row's sum exceeds 1; 0 if not requested */
    double sum;                   /* of the prices: a lower bound on every fractional cover */
    double *share;                /* by row: its value in a fractional cover */
    uint64_t work;                /* in units of about a microsecond */
} witness_prices;

/* Prices of the witnesses in `wanted` with maximal sum (up to a thousandth); some row holds each of
 * these witnesses. Errors: MEMORY. */
starg_status prices_find(starg_context *context, const witness_row *const *rows, size_t count,
                         const witness_row *wanted, witness_prices *out);
void prices_free(starg_context *context, witness_prices *prices);

#endif
