/* SPDX-License-Identifier: Apache-2.0 */
/* The generators behind starg_tetmesh_from_solid. */
#ifndef STARG_TETRA_GENERATE_H
#define STARG_TETRA_GENERATE_H

#include "geometry/winding.h"
#include "mesh/solid.h"
#include "tetra/tetmesh.h"

#define TETRA_STAGE "tetrahedra"

/* Input of the built-in generators. */
typedef struct tetra_shape {
    const starg_mesh *mesh;
    const bvh *tree;            /* of the surface's faces */
    const winding_field *field; /* NULL: the mesh is closed, and its winding number an integer */
    double volume;              /* approximate; negative if the faces of an open mesh face inward */
} tetra_shape;

/* Runs the program `tetgen` on the surface; `volume` is the largest allowed for a tetrahedron, or 0
 * for as few tetrahedra as possible. The boundary of the result equals the surface, face by face.
 * Errors: SOLVER (any failure of the program), MEMORY, CANCELLED. */
starg_status tetra_by_tetgen(starg_context *context, const starg_solid *solid, double volume,
                             const starg_tetra_options *options, starg_tetmesh **out);

/* Isosurface stuffing with cubes of side `spacing`, or smaller ones if no lattice point is inside;
 * *spacing receives the one used. Errors: SOLVER (none is small enough), MEMORY, CANCELLED. */
starg_status tetra_by_stuffing(starg_context *context, const tetra_shape *shape, double *spacing,
                               starg_tetmesh **out);

/* Largest distance from one surface to another, at points at most `step` apart. Errors: MEMORY,
 * CANCELLED. */
starg_status tetra_measure_one_way(starg_context *context, const starg_mesh *from, const bvh *to,
                                   double step, double *out);

/* Largest distances between the boundary of a mesh and the surface of a shape, in both directions,
 * at points at most `step` apart. Errors: MEMORY, CANCELLED. */
starg_status tetra_measure(starg_context *context, const tetra_shape *shape,
                           const starg_tetmesh *mesh, double step, double *to_surface,
                           double *from_surface);

#endif
