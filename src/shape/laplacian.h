/* SPDX-License-Identifier: Apache-2.0 */
/* The cotangent Laplacian of a triangle mesh. */
#ifndef STARG_SHAPE_LAPLACIAN_H
#define STARG_SHAPE_LAPLACIAN_H

#include <stdint.h>

#include "shape/sparse.h"
#include "starguard/mesh.h"

/* A symmetric, positive semidefinite matrix with zero row sums, stored completely and by columns,
 * and a positive diagonal of masses that sum to 1. The eigenvalues of L x = lambda M x are those of
 * the surface times its area, hence independent of scale. */
typedef struct laplacian {
    size_t count;
    int64_t *starts; /* count + 1 */
    int64_t *rows;
    double *values;
    double *masses;
    uint32_t *row_of; /* per vertex of the mesh: its row, or LAPLACIAN_NO_ROW */
} laplacian;

#define LAPLACIAN_NO_ROW UINT32_MAX

/* The mesh may be open; vertices without a face of positive extent are omitted. A mesh with few
 * vertices is subdivided first, which keeps its surface, since a spectrum needs resolution. Errors:
 * MESH (no area), MEMORY, CANCELLED. */
starg_status laplacian_create(starg_context *context, const starg_mesh *mesh, laplacian *out);

/* Factorizes L + shift M, which is positive definite for shift > 0. Errors: SOLVER, MEMORY. */
starg_status laplacian_factorise(starg_context *context, const laplacian *l, double shift,
                                 sparse_factors **out);
void laplacian_free(starg_context *context, laplacian *l);

#endif
