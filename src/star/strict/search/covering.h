/* SPDX-License-Identifier: Apache-2.0 */
/* A few guards that see all of a region, and the borders between their parts. */
#ifndef STARG_STAR_STRICT_SEARCH_COVERING_H
#define STARG_STAR_STRICT_SEARCH_COVERING_H

#include "star/strict/search/border.h"

enum { COVERING_MOST = 4 };

typedef struct covering_options {
    double margin;             /* that guards keep to all planes, in unit coordinates */
    const double (*starts)[3]; /* places in the region */
    size_t start_count;        /* at least one */
} covering_options;

/* Looks for `guards` (2 to COVERING_MOST) star-shaped parts. What is found is rounded:
 * to be proven on the cut mesh. Errors: MEMORY. */
starg_status covering_find(const region *r, size_t guards, const covering_options *options,
                           starg_rng *rng, region_scratch *scratch, border_plan *plan, bool *found);

#endif
