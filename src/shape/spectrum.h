/* SPDX-License-Identifier: Apache-2.0 */
/* The smallest eigenvalues of a Laplacian, and their functions. */
#ifndef STARG_SHAPE_SPECTRUM_H
#define STARG_SHAPE_SPECTRUM_H

#include "shape/laplacian.h"

/* The `wanted` smallest solutions of L x = lambda M x in ascending order, the zeros among them;
 * wanted < l->count. `functions`: NULL, or room for as many columns of l->count numbers, which are
 * orthonormal in the masses. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status spectrum_smallest(starg_context *context, const laplacian *l, size_t wanted,
                               double *eigenvalues, double *functions);

#endif
