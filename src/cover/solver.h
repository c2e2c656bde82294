/* SPDX-License-Identifier: Apache-2.0 */
/* What the two users of the solver library share: its lock and its clock. */
#ifndef STARG_COVER_SOLVER_H
#define STARG_COVER_SOLVER_H

#include <Clp_C_Interface.h>

#include "cover/instance.h"

/* Takes the process-wide lock without which two solves at once fail silently; waits in slices, so
 * that cancellation and the time limit hold meanwhile. *held is false when the time limit struck
 * first, the system has no lock to give, or the library was given up. Errors: CANCELLED. */
starg_status cover_solver_lock(cover_run *run, bool *held);
void cover_solver_unlock(bool held);

/* The library has failed in the middle of something and is not to be called again in this process;
 * the lock is held. */
void cover_solver_give_up(void);

/* Seconds to the time limit, a little more than 0; call it only where there is one. */
double cover_seconds_left(const cover_run *run);

/* Solves a linear program by Clp's dual simplex method, from the last basis unless it is the first
 * time; false when there is no solution to read, so when it was cut short. */
bool cover_run_simplex(const cover_run *run, Clp_Simplex *model, bool first);

#endif
