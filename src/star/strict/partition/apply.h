/* SPDX-License-Identifier: Apache-2.0 */
/* Carrying out a plan of cuts, with proof. */
#ifndef STARG_STAR_STRICT_PARTITION_APPLY_H
#define STARG_STAR_STRICT_PARTITION_APPLY_H

#include "star/strict/partition/fan.h"
#include "star/strict/search/repartition.h"

enum { APPLY_MOST = REPARTITION_PARTS_MOST };

/* A piece that has got another number. */
typedef struct apply_move {
    uint32_t from, to;
} apply_move;

typedef struct apply_effect {
    bool done;
    size_t move_count;
    apply_move moves[APPLY_MOST]; /* one after the other */
} apply_effect;

/* Joins `count` pieces (at most APPLY_MOST) and cuts their union as planned. Every piece that
 * results, and every other one whose facets were split, is certified; if one fails, or if the sum
 * of squares of the new pieces is not above `least`, the partition is as it was. Guards of the new
 * pieces are the centres of their kernels, at least `margin` (unit coordinates) inside. The index
 * is built again. Errors: MEMORY. */
starg_status apply_plan(partition *p, const uint32_t *pieces, size_t count,
                        const repartition_plan *plan, double margin, double least,
                        region_scratch *scratch, apply_effect *effect);

/* Shares out pieces as planned; proofs, `margin` and index as above. Errors: MEMORY. */
starg_status apply_fan(partition *p, const fan_plan *plan, double margin, region_scratch *scratch,
                       apply_effect *effect);

/* Makes pieces a and b one, with number a (or b, if a is the last piece), if it has a kernel with
 * such a margin (certified); the last piece takes the number b. Errors: MEMORY. */
starg_status apply_join(partition *p, uint32_t a, uint32_t b, double margin,
                        region_scratch *scratch, bool *done);

/* Puts each guard into the centre of its kernel where that is certified and better. Errors: MEMORY.
 */
starg_status apply_centers(partition *p, region_scratch *scratch);

/* Of the volumes of pieces (unit coordinates): the larger, the more uneven they are. */
double sum_of_squares(const partition *p, const uint32_t *pieces, size_t count);

#endif
