/* SPDX-License-Identifier: Apache-2.0 */
/* Processes started by mpirun for one command (starguard/ranks.h): rank 0 runs it, the others help.
 * Without MPI, or if started directly, there is only this process. */
#pragma once

#include "starguard/ranks.h"

/* Connects to the other processes; call it first. */
void cli_ranks_begin(int *argc, char ***argv);

/* The connection; NULL without other processes. */
const starg_ranks *cli_ranks(void);

/* Default number of threads: the processors available to this process. */
int cli_ranks_threads(void);

/* Runs a helper and returns its exit status. */
int cli_ranks_serve(void);

/* Ends the run of rank 0 with the given exit status, and returns it. */
int cli_ranks_end(int result);
