/* SPDX-License-Identifier: Apache-2.0 */
/* New candidates that can lower the bound of a cover problem: column generation. */
#ifndef STARG_GUARD_PRICING_H
#define STARG_GUARD_PRICING_H

#include "guard/pool.h"

typedef struct pricing {
    const guard_pool *pool;
    const double *prices;           /* per column of the pool */
    const candidate_points *places; /* elsewhere, to be looked at in the first round */
    uint64_t round;                 /* makes the random numbers of each call different */
    uint64_t lines_left;            /* sight lines that may be tested; lowered by those that were */
} pricing;

/* Appends points whose columns' prices sum to more than 1, at most one for each priced column.
 * Errors: MEMORY, CANCELLED. */
starg_status price_candidates(pricing *all, candidate_points *found);

#endif
