/* SPDX-License-Identifier: Apache-2.0 */
/* The grid on which coordinates lie (mesh/grid.c). */
#ifndef STARG_MESH_GRID_H
#define STARG_MESH_GRID_H

#include "mesh/mesh.h"

/* On each axis the largest power of two or of ten of which all coordinates are multiples; 0 if all
 * are 0. */
void mesh_find_grid(const starg_mesh *mesh, double step[3]);

/* Is it coarse for edges as short as `edge`, as rounding far from the origin leaves it? */
bool mesh_grid_is_coarse(const starg_mesh *mesh, const double step[3], double edge);

#endif
