/* SPDX-License-Identifier: Apache-2.0 */
/* Heuristics: lazy greedy, dropping of needless rows, and swaps. All of them go by the weight of
 * covered columns; covering everything is the goal "all the weight". */
#ifndef STARG_COVER_GREEDY_H
#define STARG_COVER_GREEDY_H

#include "cover/state.h"

/* Adds the row with the largest need (weight of its columns that still lack rows; ties: the
 * lowest index) until the covered weight reaches `goal` or `limit` rows are chosen.
 * Errors: MEMORY, CANCELLED. */
starg_status cover_greedy(cover_run *run, cover_state *state, uint64_t goal, size_t limit);

/* Drops chosen rows, the least loss first, while the covered weight stays at least `goal`. */
void cover_drop_needless(cover_state *state, uint64_t goal);

/* Exchanges one chosen row for another while that covers more, until `goal` is reached or no
 * exchange helps. Errors: CANCELLED. */
starg_status cover_swap(cover_run *run, cover_state *state, uint64_t goal);

/* Tries to reach `goal` with one row less, again and again: drops the row of least loss, then
 * swaps. Errors: MEMORY, CANCELLED. */
starg_status cover_shrink(cover_run *run, cover_state *state, uint64_t goal);

#endif
