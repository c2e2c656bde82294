/* SPDX-License-Identifier: Apache-2.0 */
/* Wave kernel signature: where a surface vibrates strongly. */
#ifndef STARG_SHAPE_WKS_H
#define STARG_SHAPE_WKS_H

#include "shape/laplacian.h"
#include "starguard/descriptor.h"

enum { WKS_MODES = STARG_DESCRIPTOR_EIGENVALUES };

/* STARG_DESCRIPTOR_ENERGIES rows of STARG_DESCRIPTOR_SPREAD numbers: quantiles, over the surface,
 * of the strength of vibrations of about an energy at a point, 1 on average. `eigenvalues` are the
 * WKS_MODES + 1 smallest ones, ascending, the first one 0; `functions` has as many columns of
 * l->count numbers, orthonormal with respect to the masses. Errors: MEMORY. */
starg_status wks_measure(starg_context *context, const laplacian *l, const double *eigenvalues,
                         const double *functions, double *out);

#endif
