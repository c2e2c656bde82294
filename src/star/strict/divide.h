/* A plane that makes a region easier to see: the search for it. */
#ifndef STARG_STAR_STRICT_DIVIDE_H
#define STARG_STAR_STRICT_DIVIDE_H

#include "core/rng.h"
#include "star/strict/region.h"

/* What will do. */
typedef enum divide_demand {
    DIVIDE_GAIN, /* a plane such that two guards miss less than one  */
    DIVIDE_FAIR, /* if none gains, the best of those with fair shares */
    DIVIDE_HALVE /* any plane with fair shares                        */
} divide_demand;

typedef struct divide_options {
    double margin; /* that guards keep to all planes, in unit coordinates */
    int effort;    /* 1 or more: so many times the usual tries            */
    divide_demand demand;
} divide_options;

/* Looks for a plane such that one guard below it and one above it miss less of the region than any
 * single guard does. Nothing is proven. Errors: MEMORY. */
starg_status divide_find(const region *r, const divide_options *options, starg_rng *rng,
                         region_scratch *scratch, partition_plane *plane, bool *found);

#endif
