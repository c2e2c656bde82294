/* SPDX-License-Identifier: Apache-2.0 */
/* Linear relaxation of full covers. */
#pragma once

#include "cover/dual.h"

typedef struct cover_relaxation {
    double *solution;     /* per row: fraction chosen, 0 to 1 */
    double *surplus;      /* per column: coverage beyond its demand */
    int64_t *multipliers; /* per column: nearly optimal dual multipliers, integers >= 0, to be
                             proven by cover_dual_offer */
} cover_relaxation;

/* Solves the relaxation. *found is false if Clp failed. If it was cut short, the solution may
 * violate columns, but the multipliers still give a bound. Errors: MEMORY, CANCELLED. */
starg_status cover_relax(cover_run *run, const cover_instance *instance, cover_relaxation *out,
                         bool *found);
void cover_relaxation_free(cover_relaxation *relaxation);
