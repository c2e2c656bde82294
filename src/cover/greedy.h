/* SPDX-License-Identifier: Apache-2.0 */
/* Heuristics: lazy greedy, removal of redundant rows, and swaps. All maximize the weight of covered
 * columns; a full cover has the total weight as goal. */
#pragma once

#include "cover/state.h"

/* Adds the row with the largest need (weight of its columns that still lack rows; ties: lowest
 * index) until the covered weight reaches `goal` or `limit` rows are chosen. Errors: MEMORY,
 * CANCELLED. */
starg_status cover_greedy(cover_run *run, cover_state *state, uint64_t goal, size_t limit);

/* Drops chosen rows, least loss first, while the covered weight stays at least `goal`. */
void cover_drop_needless(cover_state *state, uint64_t goal);

/* Swaps a chosen row for another while that covers more, until `goal` is reached or no swap helps.
 * Errors: CANCELLED. */
starg_status cover_swap(cover_run *run, cover_state *state, uint64_t goal);

/* Repeatedly tries to reach `goal` with one row less: drops the row of least loss, then swaps.
 * Errors: MEMORY, CANCELLED. */
starg_status cover_shrink(cover_run *run, cover_state *state, uint64_t goal);
