/* SPDX-License-Identifier: Apache-2.0 */
/* Strict pieces of a solid whose surface intersects itself. */
#ifndef STARG_STAR_UNITED_H
#define STARG_STAR_UNITED_H

#include "mesh/solid.h"
#include "starguard/decompose.h"

/* Cuts the solid that the surface encloses; *out tells what of the surface is kept and how far the
 * rest is from the boundary. *out is NULL, with a notice, where the surface cannot be cut at its
 * intersections. Errors: MEMORY, CANCELLED, TIME. */
starg_status united_decompose(starg_context *context, const starg_solid *solid,
                              const starg_decompose_options *options, starg_decomposition **out);

#endif
