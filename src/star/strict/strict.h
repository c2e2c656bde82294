/* SPDX-License-Identifier: Apache-2.0 */
/* Strict star decomposition: every piece is proven to be star-shaped. */
#ifndef STARG_STAR_STRICT_STRICT_H
#define STARG_STAR_STRICT_STRICT_H

#include "core/context.h"
#include "starguard/decompose.h"
#include "visibility/kernel.h"

/* From the surface alone, which faces outward and meets itself in common vertices and edges at
 * most. *out is NULL when roundings have spoilt all cuts of some piece. Errors: MEMORY, CANCELLED.
 */
starg_status strict_decompose_surface(starg_context *context, const kernel_faces *surface,
                                      const starg_decompose_options *options,
                                      starg_decomposition **out);

/* From the boundary of tetrahedra, or from tetrahedra grown into regions where that resists.
 * Errors: MESH (a tetrahedron too thin to contain a point), MEMORY, CANCELLED. */
starg_status strict_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                      const starg_decompose_options *options,
                                      starg_decomposition **out);

#endif
