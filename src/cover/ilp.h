/* SPDX-License-Identifier: Apache-2.0 */
/* Branch and bound by the solver library. */
#pragma once

#include "cover/state.h"

/* Improves `best`, a full cover, by branch and bound; new covers are checked on the bits. *bound:
 * no cover has fewer rows; 0 if nothing was proven. Errors: MEMORY, CANCELLED. */
starg_status cover_ilp_solve(cover_run *run, const cover_instance *instance, cover_state *best,
                             size_t *bound);
