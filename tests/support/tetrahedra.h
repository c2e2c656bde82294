/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedral meshes for tests, and their boundaries. */
#ifndef TESTS_TETRAHEDRA_H
#define TESTS_TETRAHEDRA_H

#include <stdbool.h>

#include "starguard/tetra.h"

/* Delaunay tetrahedra of random points (at most 100) or of points of a small lattice, some of them
 * omitted; coordinates are multiplied by `scale`. */
starg_tetmesh *random_tetmesh(starg_context *context, uint64_t seed, size_t points, bool lattice,
                              double scale);

/* Isosurface stuffing of a procedural sample with about `target` tetrahedra. */
starg_tetmesh *sample_tetmesh(starg_context *context, const char *name, size_t target);

/* `surface` is `a` with its vertices at `positions`, which come first, subdivided or not: further
 * vertices are on its faces, and the area is the same, up to rounding. */
void assert_subdivides(const starg_mesh *surface, const starg_mesh *a, const double *positions);

#endif
