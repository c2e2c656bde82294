/* SPDX-License-Identifier: Apache-2.0 */
/* Smooths folds that skinning makes on the inner side of a joint. */
#ifndef STARG_SAMPLE_UNFOLD_H
#define STARG_SAMPLE_UNFOLD_H

#include "mesh/mesh.h"

/* Moves vertices of `posed` near folded or squeezed faces, unless the same faces are so in `rest`
 * (of the same connectivity). Errors: MEMORY, CANCELLED. */
starg_status unfold_mesh(starg_context *context, const starg_mesh *rest, starg_mesh *posed);

#endif
