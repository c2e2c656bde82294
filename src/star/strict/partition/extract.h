/* SPDX-License-Identifier: Apache-2.0 */
/* Some pieces of a partition as a partition of their own, on which a change can be tried. */
#ifndef STARG_STAR_STRICT_PARTITION_EXTRACT_H
#define STARG_STAR_STRICT_PARTITION_EXTRACT_H

#include "star/strict/partition/region.h"

/* The part's pieces are those asked for, in their order, with all of their facets, and then others
 * that have facets at an edge of these, with those facets only. The lists give the numbers in the
 * whole by those in the part, for what the part began with. */
typedef struct partition_extract {
    partition part;               /* without an index */
    STARG_ARRAY(uint32_t) facets; /* ascending */
    STARG_ARRAY(uint32_t) points;
    STARG_ARRAY(uint32_t) planes;
    STARG_ARRAY(uint32_t) pieces;
} partition_extract;

/* Of `count` pieces of a partition with an index. `out` is to be freed in any case. Errors: MEMORY.
 */
starg_status extract_make(const partition *p, const uint32_t *pieces, size_t count,
                          region_scratch *scratch, partition_extract *out);

/* Puts the part, as it is now, where it was in the partition, which has not changed since. What the
 * part has got new points, planes, pieces comes last. The index is out of date. Errors: MEMORY;
 * then the partition is of no more use. */
starg_status extract_return(partition_extract *e, partition *p);

void extract_free(partition_extract *e);

#endif
