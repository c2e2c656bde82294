/* SPDX-License-Identifier: Apache-2.0 */
/* The medial axis as its centres of maximal balls: Voronoi vertices of the surface's vertices. */
#ifndef STARG_SKELETON_MEDIAL_H
#define STARG_SKELETON_MEDIAL_H

#include "mesh/solid.h"

typedef struct medial_ball {
    double centre[3];
    double radius; /* distance to the four vertices that make it */
} medial_ball;

/* The sphere through four points; false when it is too large for doubles or they are flat. */
bool medial_circumscribe(const double *const v[4], medial_ball *ball);

/* All balls whose centre lies strictly inside the solid, at least `clearance` from its boundary;
 * in an order that depends on the input and the seed only. Free with starg_release.
 * Errors: MEMORY, CANCELLED. */
starg_status medial_balls(starg_context *context, const starg_solid *solid, double clearance,
                          medial_ball **balls, size_t *count);

/* Moves a spread-out subset of at most `wanted` balls to the front of the array; *chosen: their
 * number. Errors: CANCELLED, TIME. */
starg_status medial_thin(starg_context *context, medial_ball *balls, size_t count, size_t wanted,
                         double *scratch, size_t *chosen);

#endif
