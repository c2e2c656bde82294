/* SPDX-License-Identifier: Apache-2.0 */
/* Low-distortion map from one spherically embedded surface to another. */
#pragma once

#include "morph/align.h"

/* Moves the directions of `from` until the landmarks coincide with their counterparts and the map
 * from surface to surface, by way of the sphere, distorts little; every triangle stays positive.
 * `met` tells whether all landmarks were met. Errors: SOLVER (no room in doubles), MEMORY,
 * CANCELLED. */
starg_status compose_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                             bool *met);
