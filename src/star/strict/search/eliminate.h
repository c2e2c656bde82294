/* SPDX-License-Identifier: Apache-2.0 */
/* Piece elimination: the search for a way to share out pieces among their neighbours. */
#ifndef STARG_STAR_STRICT_SEARCH_ELIMINATE_H
#define STARG_STAR_STRICT_SEARCH_ELIMINATE_H

#include "core/rng.h"
#include "star/strict/partition/partition.h"

typedef struct eliminate_task {
    const uint32_t *pieces; /* connected; at most FAN_PIECES_MOST */
    size_t piece_count;
    size_t
        kept; /* so many are made anew within their union; below piece_count, or 1 of 1: a move */
    const uint32_t *neighbours; /* of the pieces */
    size_t neighbour_count;
    double margin; /* that guards keep to all planes, in unit coordinates */
} eliminate_task;

/* Looks for a way to share out pieces of a partition with an index among some of their neighbours
 * and the kept ones. A move must make pieces more uneven. What is found is rounded: to be proven on
 * the mesh. Errors: MEMORY. */
starg_status eliminate_find(const partition *p, const eliminate_task *task, starg_rng *rng,
                            region_scratch *scratch, fan_plan *plan, bool *found);

#endif
