/* SPDX-License-Identifier: Apache-2.0 */
/* Medial axis as centres of maximal balls: Voronoi vertices of the surface's vertices. */
#pragma once

#include "mesh/solid.h"

typedef struct medial_ball {
    double centre[3];
    double radius; /* distance to its four vertices */
} medial_ball;

/* The circumsphere of four points; false if they are flat or it is too large for doubles. */
bool medial_circumscribe(const double *const v[4], medial_ball *ball);

/* All balls whose centre lies strictly inside the solid, at least `clearance` from its boundary;
 * the order depends on the input and the seed only. Free with starg_release. Errors: MEMORY,
 * CANCELLED. */
starg_status medial_balls(starg_context *context, const starg_solid *solid, double clearance,
                          medial_ball **balls, size_t *count);

/* Moves a well spread subset of at most `wanted` balls to the front of the array; *chosen: their
 * number. Errors: CANCELLED, TIME. */
starg_status medial_thin(starg_context *context, medial_ball *balls, size_t count, size_t wanted,
                         double *scratch, size_t *chosen);
