/* SPDX-License-Identifier: Apache-2.0 */
/* Cones that meet, where there is no border. */
#ifndef STARG_STAR_STRICT_SEARCH_CROSSINGS_H
#define STARG_STAR_STRICT_SEARCH_CROSSINGS_H

#include "star/strict/search/border.h"

/* How many pairs of an own triangle and another one have cones from their guards that meet: while
 * there are any, there is no border. Counting ends at `most`. Errors: MEMORY. */
starg_status crossings_count(const border_task *task, size_t most, region_scratch *scratch,
                             size_t *count);

#endif
