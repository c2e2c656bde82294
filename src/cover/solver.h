/* SPDX-License-Identifier: Apache-2.0 */
/* Lock and clock for the two users of the solver library. */
#pragma once

#include <Clp_C_Interface.h>

#include "cover/cover.h"

/* Takes the process-wide lock, without which two simultaneous solves fail silently; waits in slices
 * to check cancellation and the time limit. *held is false if the time limit came first, no lock is
 * available, or the library was given up. Errors: CANCELLED. */
starg_status cover_solver_lock(cover_run *run, bool *held);
void cover_solver_unlock(const bool *held);

/* The library failed during a call and must not be called again in this process; the lock is
 * held. */
void cover_solver_give_up(void);

/* Seconds to the time limit, a little more than 0; requires a limit. */
double cover_seconds_left(const cover_run *run);

/* Solves a linear program by Clp's dual simplex method, warm-started unless `first`; false if there
 * is no solution to read, e.g. because it was cut short. */
bool cover_run_simplex(const cover_run *run, Clp_Simplex *model, bool first);
