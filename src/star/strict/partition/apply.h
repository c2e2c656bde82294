/* SPDX-License-Identifier: Apache-2.0 */
/* Applies a plan of cuts, with proof. */
#pragma once

#include "star/strict/partition/partition.h"

enum { APPLY_MOST = 5, CUT_PLANES_MOST = 64 };

typedef enum cut_end { CUT_GOES_ON, CUT_ENDS_TERM, CUT_ENDS_PART } cut_end;

/* Part after part, each cut from what the former ones leave, which is the last part in the end. A
 * part is the union of terms, a term what is below all of its planes. */
typedef struct cut_plan {
    int count;
    partition_plane planes[CUT_PLANES_MOST];
    cut_end ends[CUT_PLANES_MOST]; /* is it the last one of its term, or part? */
} cut_plan;

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

/* Joins `count` pieces (at most APPLY_MOST) and cuts their union into at most as many parts, as
 * planned. Certifies every new
 * piece, and every other piece whose facets were split; if one fails, or if `worth`, unless NULL,
 * does not grow, the partition is unchanged. Guards of the new pieces are the centres of their
 * kernels, at least `margin` (unit coordinates) inside. Rebuilds the index. Errors: MEMORY. */
starg_status apply_cuts(partition *p, const uint32_t *pieces, size_t count, const cut_plan *plan,
                        double margin, apply_worth worth, region_scratch *scratch,
                        apply_effect *effect);

/* Distributes pieces as planned; proofs, `margin` and index as above. Errors: MEMORY. */
starg_status apply_fan(partition *p, const fan_plan *plan, double margin, region_scratch *scratch,
                       apply_effect *effect);

/* Joins pieces a and b if the union has a kernel with this margin (certified); it gets number a (or
 * b, if a is the last piece), and the last piece gets number b. Errors: MEMORY. */
starg_status apply_join(partition *p, uint32_t a, uint32_t b, double margin,
                        region_scratch *scratch, bool *done);

/* Moves each guard to the centre of its kernel if that is certified and better. Errors: MEMORY. */
starg_status apply_centers(partition *p, region_scratch *scratch);
