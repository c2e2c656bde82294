/* SPDX-License-Identifier: Apache-2.0 */
/* How flat the tetrahedra between guards and facets are. */
#ifndef STARG_STAR_STRICT_FINISH_FLATNESS_H
#define STARG_STAR_STRICT_FINISH_FLATNESS_H

#include "star/strict/partition/partition.h"

/* Tetrahedra with a dihedral angle below this many degrees are flat, and pieces with a margin below
 * the other one have little room: the radius of the ball around the guard by the diagonal of the
 * piece's bounding box. */
#define FLATNESS_ANGLE  0.2
#define FLATNESS_MARGIN 2e-3

/* The smallest dihedral angle of the tetrahedron on a triangle of a piece, whose corners are
 * counter-clockwise from outside; negative if its guard is not strictly inside. Degrees. */
double flatness_angle(const partition *p, uint32_t number, const uint32_t corners[3]);

/* Of the bounding box of a piece, in unit coordinates; the partition has an index. */
double flatness_diagonal(const partition *p, uint32_t number);

/* What angles and the margin of a piece lack, 0 if nothing; likewise. */
double flatness_of_piece(const partition *p, uint32_t number);

/* The same for all angles, and the margins of the first pieces; without an index. */
double flatness_of_first(const partition *p, size_t count);

#endif
