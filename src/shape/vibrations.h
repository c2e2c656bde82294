/* SPDX-License-Identifier: Apache-2.0 */
/* Vibration modes of a solid's boundary. */
#ifndef STARG_SHAPE_VIBRATIONS_H
#define STARG_SHAPE_VIBRATIONS_H

#include "starguard/descriptor.h"
#include "starguard/tetra.h"

/* The smallest nonzero eigenvalues of the surface's Laplacian, ascending, times the area; and where
 * the surface vibrates (wks.h). Fills these fields of the descriptor. `surface` is the boundary
 * before pieces cut it; NULL: that of `mesh`. Errors: MESH (no area), SOLVER, MEMORY, CANCELLED. */
starg_status vibrations_measure(starg_context *context, const starg_tetmesh *mesh,
                                const starg_mesh *surface, starg_descriptor *out);

#endif
