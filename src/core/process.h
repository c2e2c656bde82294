/* SPDX-License-Identifier: Apache-2.0 */
/* Child processes and temporary folders. */
#pragma once

#include "core/context.h"

/* Runs another program, and makes private folders for its files. */

/* Runs a program: `arguments` ends with NULL, the first is the program (looked up in the search
 * path unless it contains a slash). It gets no input, its output is discarded, and it leaves no
 * core file. It is stopped after `seconds` of processor time (rounded up to whole ones), and killed
 * with its children at the context's time limit or on cancellation. Errors: SOLVER (not found,
 * killed by a signal, status other than 0, too slow; the message says which), CANCELLED. */
starg_status starg_process_run(starg_context *context, const char *stage,
                               const char *const *arguments, double seconds);

/* What a program is given and what of it is kept; all zero: nothing and no limits but `seconds`. */
typedef struct starg_process_options {
    double seconds;  /* of processor time                                        */
    size_t memory;   /* most bytes of address space; 0: no limit                  */
    char **output;   /* takes what it writes to standard output, of the context; or NULL */
    size_t *size;    /* of that                                                   */
    char *complaint; /* takes the last line that it writes to standard error; or NULL */
    size_t room;     /* of that                                                   */
} starg_process_options;

/* The same with these. Errors also: READ, MEMORY. */
starg_status starg_process_run_with(starg_context *context, const char *stage,
                                    const char *const *arguments,
                                    const starg_process_options *options);

/* Makes a folder accessible to the user only, below TMPDIR or /tmp; *path is a block of the
 * context. Errors: WRITE, MEMORY. */
starg_status starg_scratch_create(starg_context *context, const char *stage, char **path);

/* Removes the folder and its files, and frees the path; NULL is allowed. */
void starg_scratch_remove(starg_context *context, char *path);
