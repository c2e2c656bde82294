/* SPDX-License-Identifier: Apache-2.0 */
/* The grid on which coordinates lie (mesh/grid.c). */
#pragma once

#include "mesh/mesh.h"
#include "starguard/check.h"

/* Sets the grid, by axis the largest power of two or of ten of which all coordinates are multiples
 * (0 if all are 0), the shortest edge, and whether the grid is coarse for edges as short, as
 * rounding far from the origin leaves it. */
void check_steps(const starg_mesh *mesh, starg_check *check);
