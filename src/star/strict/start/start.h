/* SPDX-License-Identifier: Apache-2.0 */
/* Initial partitions. */
#pragma once

#include "core/rng.h"
#include "star/strict/partition/partition.h"

/* BSP start: cuts by planes until every piece is star-shaped. */

typedef struct bsp_options {
    uint64_t stream;      /* of random numbers: another one gives another result */
    size_t budget;        /* evaluations of open pieces, after which it is given up */
    bool to_the_end;      /* neither budget nor time end it; once the time is over, it hurries */
    const double *guards; /* guard_count x 3, or NULL: places to choose guards from */
    size_t guard_count;
    const uint32_t *pieces; /* those to be cut, or NULL: all */
    size_t piece_count;
} bsp_options;

typedef struct bsp_report {
    bool done;          /* else the partition is of no use */
    size_t evaluations; /* of open pieces: some two or three for each piece if none resists */
    uint64_t work;      /* vertices, facets and rows looked at */
} bsp_report;

/* Cuts pieces of a partition, whose guards need not see anything, until each has a certified guard.
 * The stamps of pieces that are not cut stay. Errors: MEMORY, CANCELLED. */
starg_status bsp_start(partition *p, const bsp_options *options, bsp_report *report);

/* Labels for nodes such that those across an edge go together. */

/* Labels are bits of a set. */
typedef uint32_t label_set;
enum { LABELLING_MOST = 32 };

/* Different labels may be at its two ends if each is one of those that fit there. No label fits at
 * both ends. */
typedef struct labelling_edge {
    uint32_t nodes[2];
    label_set fits[2];
} labelling_edge;

/* Every node has three edges. The lists are filled by the caller, then labelling_prepare is called;
 * the fits and `given` may change between solutions. */
typedef struct labelling {
    starg_context *context;
    STARG_ARRAY(label_set) given; /* of each node: those it may have */
    STARG_ARRAY(labelling_edge) edges;
    /* Where nothing else decides, a high rank is preferred; labels of rank 0 are for nodes that no
     * other is left for. */
    double ranks[LABELLING_MOST];

    STARG_ARRAY(label_set) left;    /* of each node; of a solution: exactly one */
    label_set ranked;               /* those with a rank above 0 */
    STARG_ARRAY(uint32_t) edges_of; /* node x 3 */
    STARG_ARRAY(uint32_t) queue;
    STARG_ARRAY(uint32_t) changed; /* nodes and what they had before, to go back */
} labelling;

void labelling_free(labelling *l);

/* Errors: MEMORY. */
starg_status labelling_prepare(labelling *l);

/* *found is false when there is no solution, and sometimes when there is one that is hard to find.
 * Another state of `rng` gives another solution. Errors: MEMORY. */
starg_status labelling_solve(labelling *l, starg_rng *rng, bool *found);
