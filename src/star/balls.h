/* SPDX-License-Identifier: Apache-2.0 */
/* Maps of star-shaped pieces to balls. */
#ifndef STARG_STAR_BALLS_H
#define STARG_STAR_BALLS_H

#include "starguard/decompose.h"

/* Fills what a decomposition holds of its maps to balls. Its pieces are star-shaped, and made of
 * tetrahedra about their guards. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status balls_make(starg_context *context, starg_decomposition *d, starg_balls kind);

#endif
