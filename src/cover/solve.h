/* SPDX-License-Identifier: Apache-2.0 */
/* The solvers behind the public function: for full covers, and for a partial target or a limit on
 * the rows. */
#pragma once

#include "cover/instance.h"

typedef struct cover_answer {
    cover_names rows;
    size_t lower_bound; /* no fewer rows reach the same */
    uint64_t weight;    /* covered by the rows; set by cover_solve_limited */
} cover_answer;

/* Full cover, with a bound. Reduces the instance in place. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_full(cover_run *run, cover_instance *instance, cover_answer *answer);

/* Covers the weight `goal`, more than 0 and less than the total; greedily unless `exact`. Errors:
 * MEMORY, CANCELLED. */
starg_status cover_solve_partial(cover_run *run, const cover_instance *instance, uint64_t goal,
                                 bool exact, cover_answer *answer);

/* Covers as much as `limit` rows (at least 1) can, up to `goal`; the answer's lower_bound is for
 * the weight it covers. *most: upper bound on the weight of `limit` rows. Searches for the optimum
 * if `exact`, otherwise greedy. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_limited(cover_run *run, const cover_instance *instance, size_t limit,
                                 uint64_t goal, bool exact, cover_answer *answer, uint64_t *most);

/* Greedy full cover, with the bound of a relaxed run. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_greedy(cover_run *run, const cover_instance *instance,
                                cover_answer *answer);
