/* SPDX-License-Identifier: Apache-2.0 */
/* The proxy level: the source of the medial axis and the skeleton of a large model. */
#ifndef STARG_GUARD_PROXY_H
#define STARG_GUARD_PROXY_H

#include "mesh/solid.h"
#include "starguard/simplify.h"

/* Is the model large enough to use a level of detail instead? */
bool proxy_wanted(const starg_solid *solid);

/* The solid of the proxy level, of the levels of `solid`; the caller owns it. An embedded one has
 * embedded levels, which are not checked again. Errors: MEMORY, CANCELLED. */
starg_status proxy_of_levels(starg_context *context, const starg_solid *solid,
                             const starg_levels *levels, starg_solid **out);

/* The same from levels built for the purpose. Errors: MEMORY, CANCELLED, TIME. */
starg_status proxy_make(starg_context *context, const starg_solid *solid, starg_solid **out);

#endif
