/* SPDX-License-Identifier: Apache-2.0 */
/* How the boundary of a solid vibrates. */
#ifndef STARG_SHAPE_VIBRATIONS_H
#define STARG_SHAPE_VIBRATIONS_H

#include "starguard/descriptor.h"
#include "starguard/tetra.h"

/* The smallest eigenvalues behind 0 of the surface's Laplacian, ascending, times the area; and
 * where the surface vibrates (wks.h). Fills these fields of the descriptor. `surface` is the
 * boundary as it was before pieces cut it up; NULL: that of `mesh`. Errors: MESH (no area), SOLVER,
 * MEMORY, CANCELLED. */
starg_status vibrations_measure(starg_context *context, const starg_tetmesh *mesh,
                                const starg_mesh *surface, starg_descriptor *out);

#endif
