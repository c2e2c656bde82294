/* SPDX-License-Identifier: Apache-2.0 */
/* Running another program, and the private folder that its files live in. */
#ifndef STARG_TETRA_PROCESS_H
#define STARG_TETRA_PROCESS_H

#include "core/context.h"

/* Runs a program to its end: `arguments` ends with NULL, the first is the program (looked up in the
 * search path unless it holds a slash). It has no input, its output is dropped, and it leaves no
 * core file. It is killed, with what it has started, after `seconds`, when the context's time limit
 * strikes, or on cancellation.
 * Errors: SOLVER (not found, killed by a signal, status other than 0, too slow; the message says
 * which), CANCELLED. */
starg_status starg_process_run(starg_context *context, const char *stage,
                               const char *const *arguments, double seconds);

/* Makes a folder that only the user may enter, below TMPDIR or /tmp; *path is a block of the
 * context. Errors: WRITE, MEMORY. */
starg_status starg_scratch_create(starg_context *context, const char *stage, char **path);

/* Removes the folder and the files in it, and frees the path; NULL is fine. */
void starg_scratch_remove(starg_context *context, char *path);

#endif
