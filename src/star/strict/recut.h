/* The search for planes that cut a region into a given number of star-shaped parts. */
#ifndef STARG_STAR_STRICT_RECUT_H
#define STARG_STAR_STRICT_RECUT_H

#include "core/rng.h"
#include "star/strict/region.h"

enum { RECUT_PARTS_MOST = 5 };

/* Cut after cut: what is below each plane is a part, what is above goes on to the next cut and is
 * the last part in the end. */
typedef struct recut_plan {
    int cuts;
    partition_plane planes[RECUT_PARTS_MOST - 1];
} recut_plan;

typedef struct recut_options {
    double margin;  /* that guards keep to all planes, in unit coordinates            */
    int directions; /* random ones tried for each cut                                 */
    int steps;      /* of the climb from each of the best                             */
    bool anywhere;  /* take a place for the last cut by chance, not the roomiest      */
} recut_options;

/* Looks for `parts` (1 to RECUT_PARTS_MOST) parts. What is found is rounded: to be proven on the
 * cut mesh. Errors: MEMORY. */
starg_status recut_find(const region *r, int parts, const recut_options *options, starg_rng *rng,
                        region_scratch *scratch, recut_plan *plan, bool *found);

#endif
