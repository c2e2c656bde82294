/* SPDX-License-Identifier: Apache-2.0 */
/* Smallest eigenvalues and eigenfunctions of a Laplacian. */
#ifndef STARG_SHAPE_SPECTRUM_H
#define STARG_SHAPE_SPECTRUM_H

#include "shape/laplacian.h"

/* The `wanted` smallest solutions of L x = lambda M x in ascending order, zeros included; wanted <
 * l->count. `functions`: NULL, or room for `wanted` columns of l->count numbers, orthonormal with
 * respect to the masses. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status spectrum_smallest(starg_context *context, const laplacian *l, size_t wanted,
                               double *eigenvalues, double *functions);

#endif
