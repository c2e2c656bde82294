/* SPDX-License-Identifier: Apache-2.0 */
#include "cover/solver.h"

#include <math.h>
#include <threads.h>
#include <time.h>

static mtx_t solver_lock;
static bool solver_lock_exists;
static bool solver_broken; /* guarded by the lock */
static once_flag solver_lock_once = ONCE_FLAG_INIT;

static void make_solver_lock(void) {
    solver_lock_exists = mtx_init(&solver_lock, mtx_timed) == thrd_success;
}

starg_status cover_solver_lock(cover_run *run, bool *held) {
    *held = false;
    call_once(&solver_lock_once, make_solver_lock);
    while (solver_lock_exists && !*held && !cover_time_is_over(run)) {
        TRY(starg_check_cancel(run->context, "ilp"));
        struct timespec until;
        timespec_get(&until, TIME_UTC);
        until.tv_nsec += 50000000;
        if (until.tv_nsec >= 1000000000) {
            until.tv_nsec -= 1000000000;
            until.tv_sec++;
        }
        *held = mtx_timedlock(&solver_lock, &until) == thrd_success;
    }
    if (*held && solver_broken) {
        mtx_unlock(&solver_lock);
        *held = false;
    }
    return STARG_OK;
}

void cover_solver_give_up(void) {
    solver_broken = true;
}

void cover_solver_unlock(const bool *held) {
    if (*held)
        mtx_unlock(&solver_lock);
}

double cover_seconds_left(const cover_run *run) {
    return fmax(0.001, starg_seconds_left(run->context));
}

bool cover_run_simplex(const cover_run *run, Clp_Simplex *model, bool first) {
    if (starg_seconds_left(run->context) < INFINITY)
        Clp_setMaximumSeconds(model, cover_seconds_left(run));
    if (first)
        Clp_initialDualSolve(model);
    else
        Clp_dual(model, 0);
    return Clp_status(model) == 0 && Clp_primalColumnSolution(model) != NULL &&
           Clp_dualRowSolution(model) != NULL;
}
