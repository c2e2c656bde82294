/* SPDX-License-Identifier: Apache-2.0 */
/* Spectra of surfaces: sparse matrices, the Laplacian, its smallest eigenvalues, and where
 * vibrations are strong. */
#pragma once

#include "core/memory.h"
#include "starguard/descriptor.h"

/* ---- sparse symmetric positive definite systems with many right-hand sides (sparse.c) ---- */

/* A matrix by columns, both triangles; duplicate entries are summed. */
typedef struct sparse_matrix {
    size_t size;
    int64_t *starts; /* of the columns, size + 1 */
    int64_t *rows;
    double *values;
} sparse_matrix;

typedef struct sparse_factors sparse_factors;

/* Factorizes a matrix. Errors, reported for `stage`: SOLVER (not positive definite), MEMORY. */
starg_status sparse_factorise(starg_context *context, const char *stage,
                              const sparse_matrix *matrix, sparse_factors **out);
void sparse_free(sparse_factors *f);
STARG_DROP(sparse, sparse_factors)

/* Solves for one right-hand side in place; `work` has `size` doubles. Any thread. */
void sparse_solve(const sparse_factors *f, double *values, double *work);

/* ---- the cotangent Laplacian of a triangle mesh (laplacian.c) ---- */

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
void laplacian_free(laplacian *l);

/* ---- smallest eigenvalues and eigenfunctions of a Laplacian (spectrum.c) ---- */

/* The `wanted` smallest solutions of L x = lambda M x in ascending order, zeros included; wanted <
 * l->count. `functions`: NULL, or room for `wanted` columns of l->count numbers, orthonormal with
 * respect to the masses. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status spectrum_smallest(starg_context *context, const laplacian *l, size_t wanted,
                               double *eigenvalues, double *functions);

/* ---- wave kernel signature: where a surface vibrates strongly (wks.c) ---- */

enum { WKS_MODES = STARG_DESCRIPTOR_EIGENVALUES };

/* STARG_DESCRIPTOR_ENERGIES rows of STARG_DESCRIPTOR_SPREAD numbers: quantiles, over the surface,
 * of the strength of vibrations of about an energy at a point, 1 on average. `eigenvalues` are the
 * WKS_MODES + 1 smallest ones, ascending, the first one 0; `functions` has as many columns of
 * l->count numbers, orthonormal with respect to the masses. Errors: MEMORY. */
starg_status wks_measure(starg_context *context, const laplacian *l, const double *eigenvalues,
                         const double *functions, double *out);
