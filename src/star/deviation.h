/* SPDX-License-Identifier: Apache-2.0 */
/* How far one surface is from another. */
#ifndef STARG_STAR_DEVIATION_H
#define STARG_STAR_DEVIATION_H

#include "geometry/bvh.h"
#include "starguard/mesh.h"

/* No point of `from` is farther than *out from the triangles of `to`, of which there are some; that
 * is too much by no more than the larger of its half and rounding, nor than the step. `extent` is
 * the size of the model. Errors: MEMORY, CANCELLED. */
starg_status deviation_bound(starg_context *context, const starg_mesh *from, const bvh *to,
                             double extent, double step, double *out);

#endif
