/* SPDX-License-Identifier: Apache-2.0 */
/* The linear relaxation of covering everything. */
#ifndef STARG_COVER_RELAX_H
#define STARG_COVER_RELAX_H

#include "cover/dual.h"

typedef struct cover_relaxation {
    double *solution;     /* per row: how much of it is chosen, 0 to 1                   */
    double *surplus;      /* per column: what it gets beyond its demand                  */
    int64_t *multipliers; /* per column: near the optimal dual ones, whole numbers >= 0:
                             feed them to cover_dual_offer, which proves their worth     */
} cover_relaxation;

/* Solves the relaxation. *found is false when Clp gave up; when it was cut short later on, the
 * solution may leave columns short, the multipliers are good for a bound all the same.
 * Errors: MEMORY, CANCELLED. */
starg_status cover_relax(cover_run *run, const cover_instance *instance, cover_relaxation *out,
                         bool *found);
void cover_relaxation_free(const cover_instance *instance, cover_relaxation *relaxation);

#endif
