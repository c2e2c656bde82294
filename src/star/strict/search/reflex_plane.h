/* SPDX-License-Identifier: Apache-2.0 */
/* Planes of reflex edges. */
#ifndef STARG_STAR_STRICT_SEARCH_REFLEX_PLANE_H
#define STARG_STAR_STRICT_SEARCH_REFLEX_PLANE_H

#include "core/rng.h"
#include "star/strict/partition/partition.h"

/* A plane through a reflex edge of a region, such that no side has a reflex edge there; or through
 * an edge in which the region's surface touches itself. *found is false when there is no such edge:
 * the region is convex up to rounding, or in parts that are. Errors: MEMORY. */
starg_status reflex_plane_find(const region *r, starg_rng *rng, region_scratch *scratch,
                               partition_plane *plane, bool *found);

#endif
