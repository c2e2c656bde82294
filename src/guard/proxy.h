/* SPDX-License-Identifier: Apache-2.0 */
/* The proxy level: what the medial axis and the skeleton of a large model are made from. */
#ifndef STARG_GUARD_PROXY_H
#define STARG_GUARD_PROXY_H

#include "mesh/solid.h"
#include "starguard/simplify.h"

/* The step from one level of detail to the next, unless told otherwise: 10,000 vertices as in the
 * paper, for large models STARG_QUARTERS. */
size_t proxy_step(size_t vertices, size_t coarsest);

/* Is the model so large that a level of detail serves better? */
bool proxy_wanted(const starg_solid *solid);

/* The solid of the level that serves, the caller's. Errors: MEMORY, CANCELLED. */
starg_status proxy_of_levels(starg_context *context, const starg_levels *levels, starg_solid **out);

/* The same of levels that are made for it. Errors: MEMORY, CANCELLED, TIME. */
starg_status proxy_make(starg_context *context, const starg_solid *solid, starg_solid **out);

#endif
