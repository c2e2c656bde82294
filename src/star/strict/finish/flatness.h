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

#endif
