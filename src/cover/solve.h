/* SPDX-License-Identifier: Apache-2.0 */
/* The two solvers behind the public call: one for covering everything, one for a partial target or
 * a limit on the rows. */
#ifndef STARG_COVER_SOLVE_H
#define STARG_COVER_SOLVE_H

#include "cover/instance.h"

typedef struct cover_answer {
    cover_names rows;
    size_t lower_bound; /* no fewer rows do the same                          */
    uint64_t weight;    /* what the rows cover; set by cover_solve_limited    */
} cover_answer;

/* Covers everything; proves what it can. Reduces the instance in place. Errors: MEMORY, CANCELLED.
 */
starg_status cover_solve_full(cover_run *run, cover_instance *instance, cover_answer *answer);

/* Covers the weight `goal`, more than 0 and less than all; greedily unless `exact`.
 * Errors: MEMORY, CANCELLED. */
starg_status cover_solve_partial(cover_run *run, const cover_instance *instance, uint64_t goal,
                                 bool exact, cover_answer *answer);

/* Covers as much as `limit` rows (at least 1) can, if need be up to `goal`; the answer's
 * lower_bound is for the weight it covers. *most: no `limit` rows cover more. With `exact` the
 * optimum is sought, otherwise greedily. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_limited(cover_run *run, const cover_instance *instance, size_t limit,
                                 uint64_t goal, bool exact, cover_answer *answer, uint64_t *most);

/* Covers everything greedily, with the bound of a relaxed run. Errors: MEMORY, CANCELLED. */
starg_status cover_solve_greedy(cover_run *run, const cover_instance *instance,
                                cover_answer *answer);

#endif
