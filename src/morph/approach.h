/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra whose surface comes as near to B as they allow. */
#pragma once

#include "morph/deform.h"

/* How far the surface is off B in the end. */
typedef struct approach_result {
    size_t inverted; /* tetrahedra: 0 on success */
    size_t strayed;  /* vertices of the surface that are off B's surface in A's faces */
    double farthest; /* the farthest, in diagonals of B */
} approach_result;

/* Moves the vertices, whose surface is in place in B, until every tetrahedron is positive, and then
 * those of the surface back: to their places, or to others on that surface. `a` has the faces that
 * c->surface refers to. Springs of a high strength (1 and more) keep the surface where it is, of a
 * low one let tetrahedra unfold. Errors: MEMORY, CANCELLED. */
starg_status approach(deform_mesh *c, const starg_mesh *a, double strength, approach_result *out);
