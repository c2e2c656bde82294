/* The smallest eigenvalues of a Laplacian. */
#ifndef STARG_SHAPE_SPECTRUM_H
#define STARG_SHAPE_SPECTRUM_H

#include "shape/laplacian.h"

/* The `wanted` smallest solutions of L x = lambda M x in ascending order, the zeros among them;
 * wanted < l->count. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status spectrum_smallest(starg_context *context, const laplacian *l, size_t wanted,
                               double *eigenvalues);

#endif
