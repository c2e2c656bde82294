/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a piece of a partition by a plane. */
#ifndef STARG_STAR_STRICT_PARTITION_SLICE_H
#define STARG_STAR_STRICT_PARTITION_SLICE_H

#include "star/strict/partition/partition.h"

/* Joins all of `pieces` into the first of them; facets between them are removed. The other numbers
 * keep no facets. */
void partition_join(partition *p, const uint32_t *pieces, size_t count);

/* Moves the part of piece `low` above the plane to piece `high`, which must be empty; adds facets
 * along the plane between them, and splits facets that the plane cuts, also those that meet the
 * piece only in an edge. *done is false, and the partition unusable, if all of the piece is on one
 * side or rounding makes edges of the section cross. Proves nothing about either part. Errors:
 * MEMORY. */
starg_status partition_slice(partition *p, uint32_t low, uint32_t high,
                             const partition_plane *plane, bool *done);

/* On which sides of a plane a piece has vertices; both bits if the plane cuts it. */
enum { PARTITION_BELOW = 1, PARTITION_ABOVE = 2 };
int partition_sides(const partition *p, uint32_t number, const partition_plane *plane);

/* Vertices this close to the plane of a slice count as on it, in unit coordinates (far from the
 * origin, the rounding of coordinates instead). */
#define SLICE_ON 1e-12

#endif
