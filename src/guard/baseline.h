/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STARG_GUARD_BASELINE_H
#define STARG_GUARD_BASELINE_H

#include "guard/stages.h"

/* Are p and q, as seen from the centroid of the patch, at least the angle with this cosine apart?
 */
bool baseline_holds(const starg_solid *solid, size_t patch, double cosine, const double p[3],
                    const double q[3]);

/* Adds candidates to a choice until two guards at least the baseline apart see each face, as far as
 * candidates allow, then removes guards that are no longer needed. Does nothing without a baseline.
 * Errors: MEMORY, CANCELLED. */
starg_status baseline_guards(const guard_problem *problem, const guard_pool *pool,
                             guard_selection *selection);

#endif
