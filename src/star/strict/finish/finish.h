/* SPDX-License-Identifier: Apache-2.0 */
/* The last steps: room for guards, and better tetrahedra. */
#pragma once

#include "star/strict/partition/partition.h"

/* How flat the tetrahedra between guards and facets are. */

/* Tetrahedra with a dihedral angle below this many degrees are flat, and pieces with a margin below
 * the other one have little room: the radius of the ball around the guard by the diagonal of the
 * piece's bounding box. */
#define FLATNESS_ANGLE  0.2
#define FLATNESS_MARGIN 2e-3

/* What the smallest dihedral angles of the tetrahedra on a facet lack in all, 0 if nothing;
 * infinite if the guard of a piece at the facet is not strictly inside. */
double flatness_of_facet(const partition *p, const facet *f);

/* The same for one side of the facet, which is not the outside. */
double flatness_of_side(const partition *p, const facet *f, int side);

/* Of the bounding box of a piece, in unit coordinates; the partition has an index. */
double flatness_diagonal(const partition *p, uint32_t number);

/* How far its guard is from the nearest plane of its facets; likewise. */
double flatness_room(const partition *p, uint32_t number);

/* What angles and the margin of a piece lack, 0 if nothing; likewise. */
double flatness_of_piece(const partition *p, uint32_t number);

/* The same for all angles, and the margins of the first pieces; without an index. */
double flatness_of_first(const partition *p, size_t count);

/* Guards where tetrahedra are less flat. */

/* Moves guards within their kernels, so that angles lack less, with at least these margins (one for
 * each piece, in unit coordinates). Looks at about `looks` facets at most, and subtracts how many
 * it looked at. The partition has an index. Errors: MEMORY, CANCELLED. */
starg_status settle_guards(partition *p, const double *margins, uint64_t *looks, bool *any);

/* Room for the guards of a partition. */

/* Cuts pairs of neighbours anew, so that the smallest balls in
 * kernels and the smallest angles grow; `work` bounds the vertices, facets and rows visited. Stops
 * when time runs out. Errors: MEMORY, CANCELLED. */
starg_status widen(partition *p, uint64_t work);

/* Better triangles in the borders between pieces. */

/* Adds vertices within plane borders between two pieces where the tetrahedra on them have small
 * dihedral angles, and triangulates these borders anew. Pieces and guards stay the same. Errors:
 * MEMORY. */
starg_status refine_caps(partition *p);

/* Better tetrahedra by small changes of a finished partition. */

/* Moves guards and vertices that cuts have made, merges such vertices with others, and swaps edges,
 * where angles lack less then (star/strict/finish/flatness.c). No margin gets smaller unless it
 * stays above half of FLATNESS_MARGIN. Ends when `work` (64 for each look at a facet) is done or
 * time is over. Rebuilds the index. Errors: MEMORY, CANCELLED. */
starg_status reshape(partition *p, uint64_t work);
