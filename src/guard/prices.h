/* SPDX-License-Identifier: Apache-2.0 */
/* The fractional cover of witnesses by rows, and the prices that it pays for them. */
#ifndef STARG_GUARD_PRICES_H
#define STARG_GUARD_PRICES_H

#include "core/memory.h"
#include "guard/witnesses.h"

typedef struct witness_prices {
    double price[MOST_WITNESSES]; /* no row's sum is above 1; 0 where not asked for */
    double sum;                   /* of the prices: no fractional cover is smaller */
    double *share;                /* by row: how much of it a fractional cover takes */
    uint64_t work;                /* about microseconds */
} witness_prices;

/* Prices of the witnesses in `wanted`, each of which some row holds, that sum to as much as
 * possible (but for a thousandth). Errors: MEMORY. */
starg_status prices_find(starg_context *context, const witness_row *const *rows, size_t count,
                         const witness_row *wanted, witness_prices *out);
void prices_free(starg_context *context, witness_prices *prices);

#endif
