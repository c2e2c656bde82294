/* SPDX-License-Identifier: Apache-2.0 */
/* Generalized winding number: separates inside from outside even for surfaces with holes. */
#ifndef STARG_GEOMETRY_WINDING_H
#define STARG_GEOMETRY_WINDING_H

#include "geometry/bvh.h"

/* Far-field approximation of a node. */
typedef struct winding_moment {
    double center[3], normal[3]; /* weighted by area; sum of area vectors */
    double radius;               /* of a ball about the centre that contains the node's triangles */
} winding_moment;

typedef struct winding_field {
    const bvh *tree;         /* borrowed */
    double origin[3], scale; /* moments are in units that give the surface about unit size */
    winding_moment *moments; /* one per node */
} winding_field;

/* Errors: MEMORY. */
starg_status winding_create(starg_context *context, const bvh *tree, winding_field *out);
void winding_free(starg_context *context, winding_field *field);

/* Signed solid angle of all triangles seen from p over 4 pi: 1 inside a closed outward surface, 0
 * outside, fractional near holes. The approximation is off by about 0.01. */
double winding_number(const winding_field *field, const double p[3]);

#endif
