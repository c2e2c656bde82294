/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STARG_GUARD_BASELINE_H
#define STARG_GUARD_BASELINE_H

#include "guard/stages.h"

/* Are p and q, as seen from the centroid of the face, at least as far apart as the angle of the
 * cosine? */
bool baseline_holds(const starg_mesh *mesh, size_t face, double cosine, const double p[3],
                    const double q[3]);

/* Adds candidates to a choice until two guards that are the baseline apart see each face, as far as
 * candidates allow, and takes those out that are not needed then. Nothing without a baseline.
 * Errors: MEMORY, CANCELLED. */
starg_status baseline_guards(const guard_problem *problem, const guard_pool *pool,
                             guard_selection *selection);

#endif
