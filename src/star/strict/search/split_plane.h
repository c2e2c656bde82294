/* SPDX-License-Identifier: Apache-2.0 */
/* Split-plane search: a plane that makes a region easier to see. */
#ifndef STARG_STAR_STRICT_SEARCH_SPLIT_PLANE_H
#define STARG_STAR_STRICT_SEARCH_SPLIT_PLANE_H

#include "core/rng.h"
#include "star/strict/partition/partition.h"

/* What will do. */
typedef enum split_plane_demand {
    SPLIT_PLANE_GAIN, /* a plane such that two guards miss less than one  */
    SPLIT_PLANE_FAIR, /* if none gains, the best of those with fair shares */
    SPLIT_PLANE_HALVE /* any plane with fair shares                        */
} split_plane_demand;

typedef struct split_plane_options {
    double margin; /* that guards keep to all planes, in unit coordinates */
    int effort;    /* so many times the usual tries; 0: few of them       */
    split_plane_demand demand;
    const double *places; /* more places to choose guards from */
    size_t place_count;
} split_plane_options;

/* Looks for a plane such that one guard below it and one above it miss less of the region than any
 * single guard does. Nothing is proven. Errors: MEMORY. */
starg_status split_plane_find(const region *r, const split_plane_options *options, starg_rng *rng,
                              region_scratch *scratch, partition_plane *plane, bool *found);

#endif
