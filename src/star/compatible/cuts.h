/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of compatible pieces: three and more become two. */
#ifndef STARG_STAR_COMPATIBLE_CUTS_H
#define STARG_STAR_COMPATIBLE_CUTS_H

#include "star/compatible/twin_pieces.h"

/* Divides tetrahedra, alike in both places and positive; every piece is proven afterwards. Errors:
 * MEMORY, CANCELLED. */
starg_status compatible_cut(twin_pieces *w);

#endif
