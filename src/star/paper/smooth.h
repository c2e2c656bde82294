/* SPDX-License-Identifier: Apache-2.0 */
/* Smoothing of the borders between pieces. */
#ifndef STARG_STAR_PAPER_SMOOTH_H
#define STARG_STAR_PAPER_SMOOTH_H

#include "star/paper/state.h"

/* Moves inner vertices where pieces meet; every tetrahedron stays positive. Errors: MEMORY,
 * CANCELLED. */
starg_status smooth_borders(paper_state *s);

#endif
