/* SPDX-License-Identifier: Apache-2.0 */
/* Star-shaped solids, seen from a point of each kernel. */
#pragma once

#include "morph/deform.h"

/* A point in the interior of the kernel of a solid, proven; *found: there is one. At the first
 * attempt, 0, its coordinates have few digits where the kernel is roomy, so that differences to
 * simple coordinates are exact; at others it is a random one near that. The faces of `mesh` may
 * look inward. Errors: MEMORY, CANCELLED. */
starg_status stars_center(starg_context *context, const starg_mesh *mesh, uint64_t attempt,
                          double center[3], bool *found);

/* Fills two solids with the same faces, A and the images of its vertices, by cones over the faces
 * about a point in each: one of `centers` (2 x 3), or of the kernels if that is NULL or does not
 * see all. *found: both see all faces strictly, by exact signs; else `c` is as it was, empty but
 * for its context. *surface, to which it refers, is the caller's. Errors: MESH, MEMORY, CANCELLED.
 */
starg_status stars_fill(const starg_mesh *a, const double *images, const double *centers,
                        deform_mesh *c, uint32_t **surface, bool *found);
