/* SPDX-License-Identifier: Apache-2.0 */
/* The candidates of a large model that are carried to the model itself. */
#ifndef STARG_GUARD_CARRY_H
#define STARG_GUARD_CARRY_H

#include "guard/stages.h"

/* Removes points without directions that cannot matter, by what they see of a level of detail.
 * Errors: MEMORY, CANCELLED. */
starg_status carry_candidates(const guard_problem *problem, const starg_solid *level,
                              candidate_points *points);

#endif
