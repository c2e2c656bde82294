/* SPDX-License-Identifier: Apache-2.0 */
/* Cutting a piece of a partition by a plane. */
#ifndef STARG_STAR_STRICT_PARTITION_SLICE_H
#define STARG_STAR_STRICT_PARTITION_SLICE_H

#include "star/strict/partition/partition.h"

/* Makes all of `pieces` one piece, the first of them: facets between them go. The other numbers
 * stay without facets. */
void partition_join(partition *p, const uint32_t *pieces, size_t count);

/* Gives what piece `low` has above the plane to piece `high`, which has nothing yet; facets along
 * the plane come between them, and facets that the plane cuts are split, also where they meet the
 * piece in an edge only. *done is false, and the partition is of no more use, when all of the piece
 * is on one side, or rounding has spoilt the section. Proves nothing about either part. Errors:
 * MEMORY. */
starg_status partition_slice(partition *p, uint32_t low, uint32_t high,
                             const partition_plane *plane, bool *done);

/* Vertices so near to the plane of a slice count as on it, in unit coordinates (far from the origin
 * it is as much as coordinates are rounded). */
#define SLICE_ON 1e-12

#endif
