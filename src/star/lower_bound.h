/* SPDX-License-Identifier: Apache-2.0 */
/* How few star-shaped pieces a solid can be cut into. */
#ifndef STARG_STAR_LOWER_BOUND_H
#define STARG_STAR_LOWER_BOUND_H

#include "guard/corners.h"

/* The bound of the guards holds for star-shaped pieces that make up the solid; 0: the time was over
 * before there was any. `work` is that of starg_guard_options.prove_work. Errors: those of
 * starg_guard but TIME, and MESH (the surface intersects itself, or touches otherwise than in
 * vertices and edges). */
starg_status piece_bound_find(starg_context *context, const starg_solid *solid, uint64_t work,
                              bool certified, corner_guards *out);

#endif
