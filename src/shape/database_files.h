/* SPDX-License-Identifier: Apache-2.0 */
/* Describes files to add to a database, here or in other processes. */
#ifndef STARG_SHAPE_DATABASE_FILES_H
#define STARG_SHAPE_DATABASE_FILES_H

#include "core/parallel.h"
#include "shape/sha256.h"
#include "starguard/shape.h"

typedef struct database_digest {
    uint8_t bytes[STARG_SHA256_BYTES];
} database_digest;

/* A file's data before it is stored. */
typedef struct database_file {
    char *message; /* why the file is rejected */
    char *warning; /* about a file that is not, or NULL */
    database_digest hash;
    bool known; /* stored, with all signatures */
    size_t vertices, faces;
    uint8_t *numbers[STARG_SIGNATURE_KINDS]; /* in stored form */
    size_t sizes[STARG_SIGNATURE_KINDS];
} database_file;

typedef struct database_files {
    const char *const *names;
    size_t count;
    const database_digest *stored; /* contents that need no description, ascending */
    size_t stored_count;
    database_file *files; /* sorted by name; zero before they are described */
} database_files;

/* For bsearch and qsort. */
int database_by_digest(const void *a, const void *b);

void database_file_clear(starg_context *context, database_file *file);

/* Functions of a starg_parallel_loop over `count` files; `shared` is a database_files. An item
 * describes a file. A file's errors go to its message; only MEMORY and CANCELLED end the loop. */
starg_status database_files_scratch(starg_context *context, void *shared, void **scratch);
void database_files_free_scratch(starg_context *context, void *scratch);
starg_status database_files_describe(starg_context *context, void *shared, void *scratch,
                                     size_t item);

/* Packs what a helper needs to know about the files. Errors: MEMORY. */
starg_status database_files_pack(starg_context *context, const database_files *all,
                                 starg_bytes *out);

/* A starg_parallel_remote's take, with a database_files for `shared`. */
starg_status database_files_take(starg_context *context, void *shared, size_t first, size_t count,
                                 starg_bytes_reader *reply);

#endif
