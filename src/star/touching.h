/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces that touch themselves. */
#ifndef STARG_STAR_TOUCHING_H
#define STARG_STAR_TOUCHING_H

#include "mesh/solid.h"

/* The faces of a solid with one vertex at each position (free with starg_release), or NULL when
 * these intersect, lie on one another, have no area, or touch otherwise than in common vertices and
 * edges. Errors: MEMORY, CANCELLED. */
starg_status touching_weld(starg_context *context, const starg_solid *solid, uint32_t **faces);

/* Does the surface have the outside just before every point of its faces, as an embedded one does?
 * If it touches itself, that is known where touching_weld has a result. Errors: MEMORY, CANCELLED.
 */
starg_status touching_bounds(starg_context *context, const starg_solid *solid, bool *bounds);

#endif
