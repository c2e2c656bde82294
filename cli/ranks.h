/* SPDX-License-Identifier: Apache-2.0 */
/* Several processes that mpirun has started for one command (starguard/ranks.h): rank 0 runs it,
 * the others help. In a build without MPI, and when nobody has started several, there is this one
 * alone. */
#ifndef STARGUARD_CLI_RANKS_H
#define STARGUARD_CLI_RANKS_H

#include <stdbool.h>

#include "starguard/ranks.h"

/* Finds the others, before anything else is done. */
void cli_ranks_begin(int *argc, char ***argv);

/* The way to them; NULL where there are none. */
const starg_ranks *cli_ranks(void);

/* How many threads this process should use if nobody says: the processors that it has for itself.
 */
int cli_ranks_threads(void);

/* A helper's run: its exit status. */
int cli_ranks_serve(void);

/* Ends the run of rank 0, which has the given exit status; returns it. */
int cli_ranks_end(int result);

#endif
