/* SPDX-License-Identifier: Apache-2.0 */
/* Extracts some pieces as a partition of their own, on which a change can be tried. */
#ifndef STARG_STAR_STRICT_PARTITION_EXTRACT_H
#define STARG_STAR_STRICT_PARTITION_EXTRACT_H

#include "star/strict/partition/region.h"

/* The part contains the requested pieces, in their order, with all of their facets, then other
 * pieces that have facets at an edge of these, with only those facets. The lists map numbers in the
 * part to numbers in the whole, for everything that the part started with. */
typedef struct partition_extract {
    partition part;               /* without an index */
    STARG_ARRAY(uint32_t) facets; /* ascending */
    STARG_ARRAY(uint32_t) points;
    STARG_ARRAY(uint32_t) planes;
    STARG_ARRAY(uint32_t) pieces;
} partition_extract;

/* Extracts `count` pieces of a partition with an index. `out` must be freed in any case. Errors:
 * MEMORY. */
starg_status extract_make(const partition *p, const uint32_t *pieces, size_t count,
                          region_scratch *scratch, partition_extract *out);

/* Puts the part, in its current state, back into the partition, which must not have changed. New
 * points, planes and pieces come last. The index becomes stale. Errors: MEMORY; the partition is
 * then unusable. */
starg_status extract_return(partition_extract *e, partition *p);

void extract_free(partition_extract *e);

#endif
