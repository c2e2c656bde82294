/* SPDX-License-Identifier: Apache-2.0 */
/* What no guard's region holds. */
#ifndef STARG_STAR_PAPER_UNCOLOURED_H
#define STARG_STAR_PAPER_UNCOLOURED_H

#include "star/paper/state.h"

/* Guards each uncoloured component anew and grows again, until every tetrahedron has a colour.
 * There are no more than `max_pieces` pieces (0: any number) unless parts of the mesh have no guard
 * yet, and no more of them once time is over, which *time_limited then tells. Errors: MEMORY,
 * CANCELLED. */
starg_status uncoloured_regrow(paper_state *s, size_t max_pieces, bool *time_limited);

#endif
