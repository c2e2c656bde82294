/* SPDX-License-Identifier: Apache-2.0 */
/* A partition as tetrahedra. */
#ifndef STARG_STAR_STRICT_PARTITION_CONE_H
#define STARG_STAR_STRICT_PARTITION_CONE_H

#include "star/strict/partition/partition.h"

/* One tetrahedron for each facet of each piece, with the piece's guard as its fourth vertex; all
 * are positive because the guard is strictly inside the facet's plane. Points come first, in their
 * order, then the guards. `labels` (a block of the context) holds the piece of each tetrahedron.
 * Errors: MEMORY. */
starg_status cone_all(const partition *p, starg_tetmesh **mesh, int32_t **labels);

#endif
