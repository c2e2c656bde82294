/* SPDX-License-Identifier: Apache-2.0 */
/* Region growing by node merging. */
#ifndef STARG_STAR_PAPER_GROWTH_H
#define STARG_STAR_PAPER_GROWTH_H

#include "star/paper/state.h"

/* Guards whose pieces grow: guard i gives colour first_colour + i. */
typedef struct paper_front {
    const paper_guard *guards;
    size_t count;
    int32_t first_colour;
} paper_front;

/* Colours the homes of the guards, as far as they are uncoloured, and from there every uncoloured
 * tetrahedron whose predecessors have its colour, biggest cost first. */
void growth_strict(paper_state *s, const paper_front *front);

/* Colours uncoloured tetrahedra of `domain` that share a face with a region of the front and have
 * at least `least` vertices that its guard sees; most vertices first, then the nearest to the
 * guard. */
void growth_relaxed(paper_state *s, const paper_front *front, const uint32_t *domain, size_t count,
                    int least);

/* Colours uncoloured tetrahedra of `domain` like a region that they touch, whatever its guard sees;
 * those that hang together with no region stay as they are. */
void growth_absorb(paper_state *s, const uint32_t *domain, size_t count);

#endif
