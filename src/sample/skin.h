/* SPDX-License-Identifier: Apache-2.0 */
/* Bends a mesh with the joints of a figure. */
#ifndef STARG_SAMPLE_SKIN_H
#define STARG_SAMPLE_SKIN_H

#include "core/context.h"
#include "sample/figure.h"

/* Moves `vertices` (count x 3, on the figure's surface in its rest pose) into a pose.
 * Errors: MEMORY, CANCELLED. */
starg_status skin_pose(starg_context *context, const figure *f, int pose, double *vertices,
                       size_t count);

#endif
