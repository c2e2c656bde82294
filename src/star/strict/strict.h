/* SPDX-License-Identifier: Apache-2.0 */
/* Strict star decomposition: every piece is proven to be star-shaped. */
#ifndef STARG_STAR_STRICT_STRICT_H
#define STARG_STAR_STRICT_STRICT_H

#include "core/context.h"
#include "starguard/decompose.h"

/* Errors: MESH, MEMORY, CANCELLED. */
starg_status strict_decompose(starg_context *context, const starg_tetmesh *mesh,
                              const starg_decompose_options *options, starg_decomposition **out);

#endif
