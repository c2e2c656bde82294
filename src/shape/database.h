/* SPDX-License-Identifier: Apache-2.0 */
/* The database of shapes: its file, its records, how models come in and are found. */
#pragma once

#include <sqlite3.h>

#include "core/parallel.h"
#include "starguard/database.h"

static inline void statement_drop(sqlite3_stmt **statement) {
    sqlite3_finalize(*statement);
}

/* ---- SHA-256 (FIPS 180-4) of a block of memory: identifies equal files (sha256.c) ---- */

enum { STARG_SHA256_BYTES = 32 };

void starg_sha256(const void *bytes, size_t size, uint8_t digest[STARG_SHA256_BYTES]);

/* ---- connection, statements, and messages for SQLite's errors (database.c) ---- */

struct starg_database {
    starg_context *context;
    sqlite3 *handle;
    char *path;
};

extern const char DATABASE_STAGE[];

starg_status database_run(starg_database *database, const char *sql);
starg_status database_prepare(starg_database *database, const char *sql, sqlite3_stmt **out);

/* Reads a row; *row is false at the end. Resets a finished statement. */
starg_status database_step(starg_database *database, sqlite3_stmt *statement, bool *row);

/* Write transactions; rolling back never fails. */
starg_status database_begin(starg_database *database);
starg_status database_commit(starg_database *database);
void database_roll_back(starg_database *database);

/* ---- reading (database_read.c) ---- */

typedef STARG_ARRAY(starg_database_model) database_models;

void database_models_clear(database_models *list);

/* Moves the list to the result. */
starg_status database_models_hand_over(starg_context *context, database_models *list,
                                       starg_database_models **out);

/* Reads all rows of a statement, with the columns id, path, hash, vertices, faces; if `kind` is not
 * negative, also version and numbers of its signature. */
starg_status database_read_rows(starg_database *database, sqlite3_stmt *statement, int kind,
                                database_models *list);

/* Little-endian on any machine. */
void database_read_doubles(const uint8_t *bytes, size_t count, double *out);

/* Reads a signature from the columns version and numbers, from `first` on; the model's id is column
 * 0. */
starg_status database_read_signature(starg_database *database, sqlite3_stmt *row, int first,
                                     starg_signature_kind kind, starg_signature **out);

starg_status database_check_kind(starg_database *database, starg_signature_kind kind);

/* ---- sketches (database_sketches.c) ---- */

/* Files of earlier versions have no table of sketches; queries then read all signatures. */
starg_status database_has_sketches(starg_database *database, bool *yes);

/* Makes the table, of the signatures there, if it is missing. */
starg_status database_add_sketches(starg_database *database);

extern const char DATABASE_SKETCHES[], DATABASE_INSERT_SKETCH[];

/* Stores the sketch of a stored signature of the present version by DATABASE_INSERT_SKETCH. Kinds
 * without sketches and damaged numbers get none. */
starg_status database_store_sketch(starg_database *database, sqlite3_stmt *statement, int64_t model,
                                   starg_signature_kind kind, const uint8_t *bytes, size_t size);

/* ---- text (database.c) ---- */

/* Copies text to the context's memory; NULL when out of memory. */
char *database_copy(starg_context *context, const char *text);

/* The file name at the end of a path. */
const char *database_name(const char *path);

/* ---- files to add to a database, described here or in other processes (database_files.c) ---- */

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

void database_file_clear(database_file *file);

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
