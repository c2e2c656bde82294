/* The solver library behind a lock: dual multipliers from Clp, branch and bound from CBC. */
#ifndef STARG_COVER_ILP_H
#define STARG_COVER_ILP_H

#include "cover/dual.h"

/* Multipliers near the optimal ones of the linear relaxation, as whole numbers >= 0: feed them to
 * cover_dual_offer, which proves what they are worth. *found is false when Clp gave up.
 * Errors: MEMORY, CANCELLED. */
starg_status cover_lp_multipliers(cover_run *run, const cover_instance *instance,
                                  int64_t *multipliers, bool *found);

/* Looks for a cover of everything with at most `most` rows by branch and bound. A cover, checked
 * on the bits, goes to `best` with *found set. *bound: no cover of at most `most` rows has fewer
 * rows; most + 1 says that there is none. 0 when nothing was proven. Errors: MEMORY, CANCELLED. */
starg_status cover_ilp_solve(cover_run *run, const cover_instance *instance, size_t most,
                             cover_state *best, bool *found, size_t *bound);

#endif
