/* SPDX-License-Identifier: Apache-2.0 */
/* Views from all over a solid. */
#ifndef STARG_SHAPE_VIEWS_H
#define STARG_SHAPE_VIEWS_H

#include "shape/rays.h"

/* STARG_DESCRIPTOR_VIEW rows of STARG_DESCRIPTOR_SPREAD lengths: row k has quantiles, over points
 * uniform in the solid, of the k-th quantile of a point's distances to the boundary. Errors:
 * MEMORY, CANCELLED. */
starg_status views_measure(starg_context *context, const starg_tetmesh *mesh,
                           const ray_caster *caster, double *out);

#endif
