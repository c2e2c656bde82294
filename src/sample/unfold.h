/* SPDX-License-Identifier: Apache-2.0 */
/* Smooths away the folds that skinning makes in the crook of a joint. */
#ifndef STARG_SAMPLE_UNFOLD_H
#define STARG_SAMPLE_UNFOLD_H

#include "mesh/mesh.h"

/* Moves vertices of `posed` near faces that are folded or squeezed, unless the same faces of `rest`
 * (of the same connectivity) are. Errors: MEMORY, CANCELLED. */
starg_status unfold_mesh(starg_context *context, const starg_mesh *rest, starg_mesh *posed);

#endif
