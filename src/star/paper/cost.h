/* SPDX-License-Identifier: Apache-2.0 */
/* How many tetrahedra depend on each. */
#ifndef STARG_STAR_PAPER_COST_H
#define STARG_STAR_PAPER_COST_H

#include "star/paper/state.h"

/* Fills the costs of the `count` tetrahedra of `domain` (none twice) from the guard's `toward`.
 * `waiting` and `stack` have room for every tetrahedron of the mesh; `waiting` is zero in the
 * domain and left so. */
void cost_accumulate(const paper_state *s, paper_guard *g, const uint32_t *domain, size_t count,
                     uint32_t *waiting, uint32_t *stack);

#endif
