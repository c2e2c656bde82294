/* SPDX-License-Identifier: Apache-2.0 */
/* Whole files in, whole files out: reading into memory, and writing to a temporary name that is
 * renamed only when everything has reached the disk. */
#ifndef STARG_CORE_FILE_H
#define STARG_CORE_FILE_H

#include <stdio.h>

#include "core/context.h"
#include "core/private.h"

/* Largest file that is read, in bytes. */
#define STARG_FILE_LIMIT ((size_t)2 << 30)

/* Reads all of `path` ("-": standard input) into a block of the context, with one zero byte
 * behind the end. Errors: READ, MEMORY. */
starg_status starg_file_read(starg_context *context, const char *stage, const char *path,
                             char **bytes, size_t *size) STARG_PRIVATE(starg_file_read);

/* Opens a new, empty file beside `path` for reading and writing; `name`, which has room for
 * STARG_FILE_SUFFIX bytes more than `path`, receives its name. One that a killed process left
 * behind is passed by. The descriptor, or -1 with errno set. */
enum { STARG_FILE_SUFFIX = 64 };
int starg_file_temporary(const char *path, char *name) STARG_PRIVATE(starg_file_temporary);

/* An output that appears under its name only when it is committed. */
typedef struct starg_output {
    FILE *stream; /* to be written with stdio; errors are found at commit */
    starg_context *context;
    const char *stage;
    char *path, *temporary; /* both NULL for standard output */
} starg_output;

/* Opens an output for `path` ("-": standard output). Errors: WRITE, MEMORY. */
starg_status starg_output_open(starg_context *context, const char *stage, const char *path,
                               starg_output *output) STARG_PRIVATE(starg_output_open);

/* Flushes, closes and renames; removes the temporary file when anything failed. */
starg_status starg_output_commit(starg_output *output) STARG_PRIVATE(starg_output_commit);

/* Closes and removes what was written so far; harmless after commit. */
void starg_output_discard(starg_output *output) STARG_PRIVATE(starg_output_discard);

#endif
