/* SPDX-License-Identifier: Apache-2.0 */
/* Reads whole files, and writes whole files: output goes to a temporary file, renamed once
 * everything is on disk. */
#pragma once

#include <locale.h>
#include <stdio.h>

#include "core/context.h"

/* Largest file accepted, in bytes. */
#define STARG_FILE_LIMIT ((size_t)2 << 30)

/* Reads `path` ("-": standard input) into a block of the context, followed by one zero byte.
 * Errors: READ, MEMORY. */
starg_status starg_file_read(starg_context *context, const char *stage, const char *path,
                             char **bytes, size_t *size) STARG_PRIVATE(starg_file_read);

/* Creates a new file beside `path`, open for reading and writing. `name` receives its name and has
 * room for STARG_FILE_SUFFIX bytes more than `path`. Skips leftovers of killed processes. Returns
 * the descriptor, or -1 with errno set. */
enum { STARG_FILE_SUFFIX = 64 };
int starg_file_temporary(const char *path, char *name) STARG_PRIVATE(starg_file_temporary);

/* An output that gets its name when it is committed. */
typedef struct starg_output {
    FILE *stream; /* for stdio; commit reports write errors */
    starg_context *context;
    const char *stage;
    char *path, *temporary; /* NULL for standard output */
} starg_output;

/* Opens an output for `path` ("-": standard output). Errors: WRITE, MEMORY. */
starg_status starg_output_open(starg_context *context, const char *stage, const char *path,
                               starg_output *output) STARG_PRIVATE(starg_output_open);

/* Flushes, closes and renames; on failure removes the temporary file. */
starg_status starg_output_commit(starg_output *output) STARG_PRIVATE(starg_output_commit);

/* Closes and removes the temporary file; does nothing after commit. */
void starg_output_discard(starg_output *output) STARG_PRIVATE(starg_output_discard);

/* Numbers are read and written as in C, whatever the locale of the program. */

typedef struct starg_c_locale {
    locale_t own, before;
} starg_c_locale;

/* Gives the calling thread the C locale until it leaves; `locale` starts as zero. Errors: MEMORY.
 */
starg_status starg_c_locale_enter(starg_context *context, starg_c_locale *locale)
    STARG_PRIVATE(starg_c_locale_enter);
/* Does nothing if it was not entered. */
void starg_c_locale_leave(starg_c_locale *locale) STARG_PRIVATE(starg_c_locale_leave);
