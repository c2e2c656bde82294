/* SPDX-License-Identifier: Apache-2.0 */
/* Star decomposition by growth from guards [YL11, section 4]. */
#ifndef STARG_STAR_PAPER_PAPER_H
#define STARG_STAR_PAPER_PAPER_H

#include "core/context.h"
#include "starguard/decompose.h"

/* Labels the tetrahedra of a copy of the mesh, whose inner vertices move a little where pieces
 * meet. Errors: MEMORY, CANCELLED. */
starg_status paper_decompose(starg_context *context, const starg_tetmesh *mesh,
                             const starg_decompose_options *options, starg_decomposition **out);

#endif
