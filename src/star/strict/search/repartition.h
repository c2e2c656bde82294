/* SPDX-License-Identifier: Apache-2.0 */
/* Repartition: the search for planes that cut a region into a given number of star-shaped parts. */
#ifndef STARG_STAR_STRICT_SEARCH_REPARTITION_H
#define STARG_STAR_STRICT_SEARCH_REPARTITION_H

#include "core/rng.h"
#include "star/strict/partition/partition.h"

enum { REPARTITION_PARTS_MOST = 5 };

/* Cut after cut: what is below each plane is a part, what is above goes on to the next cut and is
 * the last part in the end. */
typedef struct repartition_plan {
    int cuts;
    partition_plane planes[REPARTITION_PARTS_MOST - 1];
} repartition_plan;

typedef struct repartition_options {
    double margin;  /* that guards keep to all planes, in unit coordinates            */
    int directions; /* random ones tried for each cut                                 */
    int steps;      /* of the climb from each of the best                             */
    bool anywhere;  /* take a place for the last cut by chance, not the roomiest      */
} repartition_options;

/* Looks for `parts` (1 to REPARTITION_PARTS_MOST) parts. What is found is rounded: to be proven on
 * the cut mesh. Errors: MEMORY. */
starg_status repartition_find(const region *r, int parts, const repartition_options *options,
                              starg_rng *rng, region_scratch *scratch, repartition_plan *plan,
                              bool *found);

#endif
