/* SPDX-License-Identifier: Apache-2.0 */
/* BSP start: cuts by planes until every piece is star-shaped. */
#ifndef STARG_STAR_STRICT_START_BSP_START_H
#define STARG_STAR_STRICT_START_BSP_START_H

#include "star/strict/partition/partition.h"

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

#endif
