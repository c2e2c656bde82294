/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of maps between solids. */
#pragma once

#include "morph/deform.h"
#include "starguard/solidmap.h"

/* The images of A's vertices on a ball of radius 1 or a cube of edge 2 (solid_shape.c); a block of
 * the context. Errors: MESH, SOLVER, MEMORY, CANCELLED. */
starg_status solid_map_shape(starg_context *context, const starg_mesh *a, starg_solid_shape shape,
                             double **images);

/* Puts tetrahedra, positive in both places, into pieces, and measures; `cut`: divides them where
 * that saves pieces. Errors: MESH, MEMORY, CANCELLED. */
starg_status solid_map_finish(starg_context *context, const deform_mesh *c, bool cut,
                              starg_solid_map **out);

/* The same for cones: a label for each tetrahedron, and the last `count` vertices see one piece
 * each. Errors: MEMORY, CANCELLED. */
starg_status solid_map_finish_cones(starg_context *context, const deform_mesh *c,
                                    const uint32_t *labels, size_t count, starg_solid_map **out);

/* Exponents of the extents of both places, as units of length. */
void solid_map_exponents(const starg_solid_map *map, int out[2]);

/* The largest over the smallest singular value of a tetrahedron's map, and its volume in A, in
 * those units. */
double solid_map_ratio(const starg_solid_map *map, size_t t, const int exponents[2],
                       double *volume);

static inline void starg_solid_map_drop(starg_solid_map **map) {
    starg_solid_map_free(NULL, *map);
}
