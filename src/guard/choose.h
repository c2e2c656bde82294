/* SPDX-License-Identifier: Apache-2.0 */
/* The cover problem of a pool. */
#ifndef STARG_GUARD_CHOOSE_H
#define STARG_GUARD_CHOOSE_H

#include "guard/pool.h"
#include "guard/weights.h"
#include "starguard/cover.h"

STARG_DROP(starg_cover, starg_cover)

/* What a stage asks of the cover. */
typedef struct choice {
    starg_cover_method method;
    size_t max_nodes;
    const uint32_t *given; /* candidates that are already chosen */
    size_t given_count;
    bool prices;
} choice;

/* The weight that must be seen: UINT64_MAX for all that can be. */
uint64_t choose_target(const guard_pool *pool, const column_weights *weights);

/* Chooses candidates of a non-empty pool: as many as the options' coverage, redundancy and limit
 * require. Errors: MEMORY, CANCELLED. */
starg_status choose_candidates(const guard_pool *pool, const column_weights *weights,
                               const choice *how, starg_cover **out);

#endif
