/* SPDX-License-Identifier: Apache-2.0 */
/* How good the tetrahedra of a decomposition are. */
#ifndef STARG_STAR_ANGLES_H
#define STARG_STAR_ANGLES_H

#include "starguard/decompose.h"

/* The smallest dihedral angle of a tetrahedron, in degrees. The first corner is the origin. */
double angles_smallest(const double corners[4][3]);

/* Sets smallest_angle and median_angle. Errors: MEMORY. */
starg_status angles_measure(starg_context *context, starg_decomposition *d);

/* Sets smallest_angle_made, for the model whose surface was kept. Errors: MEMORY. */
starg_status angles_tell_apart(starg_context *context, const starg_mesh *model,
                               starg_decomposition *d);

#endif
