/* SPDX-License-Identifier: Apache-2.0 */
/* The scene of a guards result as the verifier sees it. */
#ifndef STARG_VERIFY_SPACE_H
#define STARG_VERIFY_SPACE_H

#include "starguard/verify.h"
#include "verify/surface.h"

/* The surface of the model and of the obstacles of a result, which faces out of its free space; of
 * a plain solid verify_surface_create. `obstacles` has one mesh for each that the result names.
 * Errors: MESH, ARGUMENT (other obstacles than those of the result), MEMORY, CANCELLED. */
starg_status verify_space_create(starg_context *context, const starg_mesh *mesh,
                                 const starg_mesh *const *obstacles, size_t obstacle_count,
                                 const starg_guards *guards, verify_surface **out);

#endif
