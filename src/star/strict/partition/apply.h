/* SPDX-License-Identifier: Apache-2.0 */
/* Applies a plan of cuts, with proof. */
#ifndef STARG_STAR_STRICT_PARTITION_APPLY_H
#define STARG_STAR_STRICT_PARTITION_APPLY_H

#include "star/strict/partition/partition.h"
#include "star/strict/search/border.h"
#include "star/strict/search/repartition.h"

enum { APPLY_MOST = REPARTITION_PARTS_MOST };

/* A piece that was renumbered. */
typedef struct apply_move {
    uint32_t from, to;
} apply_move;

typedef struct apply_effect {
    bool done;
    size_t move_count;
    apply_move moves[APPLY_MOST]; /* one after the other */
} apply_effect;

/* What a change is to increase: of an extract with all facets that it may concern, and the first
 * `count` pieces complete. */
typedef double (*apply_worth)(const partition *part, size_t count);

/* Joins `count` pieces (at most APPLY_MOST) and cuts their union as planned. Certifies every new
 * piece, and every other piece whose facets were split; if one fails, or if `worth`, unless NULL,
 * does not grow, the partition is unchanged. Guards of the new pieces are the centres of their
 * kernels, at least `margin` (unit coordinates) inside. Rebuilds the index. Errors: MEMORY. */
starg_status apply_plan(partition *p, const uint32_t *pieces, size_t count,
                        const repartition_plan *plan, double margin, apply_worth worth,
                        region_scratch *scratch, apply_effect *effect);

/* The same for parts with borders of several planes, at most as many as pieces. Errors: MEMORY. */
starg_status apply_borders(partition *p, const uint32_t *pieces, size_t count,
                           const border_plan *plan, double margin, apply_worth worth,
                           region_scratch *scratch, apply_effect *effect);

/* Distributes pieces as planned; proofs, `margin` and index as above. Errors: MEMORY. */
starg_status apply_fan(partition *p, const fan_plan *plan, double margin, region_scratch *scratch,
                       apply_effect *effect);

/* Joins pieces a and b if the union has a kernel with this margin (certified); it gets number a (or
 * b, if a is the last piece), and the last piece gets number b. Errors: MEMORY. */
starg_status apply_join(partition *p, uint32_t a, uint32_t b, double margin,
                        region_scratch *scratch, bool *done);

/* Moves each guard to the centre of its kernel if that is certified and better. Errors: MEMORY. */
starg_status apply_centers(partition *p, region_scratch *scratch);

#endif
