/* SPDX-License-Identifier: Apache-2.0 */
/* The solid that a surface encloses which intersects itself. */
#ifndef STARG_STAR_UNITED_H
#define STARG_STAR_UNITED_H

#include "mesh/solid.h"
#include "starguard/decompose.h"

/* The solid bounded by the union. *out is NULL where the surface neither touches nor intersects
 * itself and has no degenerate face, or, with a notice, where it cannot be cut at its
 * intersections. Errors: MEMORY, CANCELLED, TIME. */
starg_status united_make(starg_context *context, const starg_solid *solid, starg_solid **out);

/* Tells in `out`, pieces of the union, which faces of the solid's surface are kept, and how far the
 * rest is from the boundary. Errors: MEMORY, CANCELLED. */
starg_status united_report(starg_context *context, const starg_solid *solid,
                           const starg_solid *united, starg_decomposition *out);

#endif
