/* SPDX-License-Identifier: Apache-2.0 */
/* Landmarks on the sphere, and files of them. */
#pragma once

#include "morph/align.h"

/* Moves the directions of the present vertices of `from`, which include all landmarks, until each
 * landmark coincides with its counterpart on `to`, every triangle positive all the way. `met` tells
 * whether that succeeded. Errors: MEMORY, CANCELLED. */
starg_status landmarks_meet(sphere *from, const sphere *to, const landmark_list *landmarks,
                            bool *met);

/* Fails with MESH and names the landmark farthest from its counterpart. */
starg_status landmarks_contradict(sphere *from, const sphere *to, const landmark_list *landmarks);
