/* SPDX-License-Identifier: Apache-2.0 */
/* Branch and bound for partial targets and limited rows: the most weight that K rows can cover.
 * Exact in integers. */
#pragma once

#include "cover/weight_bound.h"

/* Finds at most `bound->rows` rows that cover more than `best` does and more than `floor`, and
 * stores the heaviest in `best`; stops once one covers `goal`. *exhausted tells that the search
 * finished: if it stored nothing there is no such choice, and if it did not reach the goal nothing
 * is heavier. Limits: max_nodes of the run, and 4,096 steps on matrix words per node. Errors:
 * MEMORY, CANCELLED. */
starg_status cover_search(cover_run *run, const cover_instance *instance,
                          const cover_weight_bound *bound, uint64_t floor, uint64_t goal,
                          cover_state *best, bool *exhausted);
