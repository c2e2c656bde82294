/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the database: connection, statements, and messages for SQLite's errors. */
#ifndef STARG_SHAPE_DATABASE_H
#define STARG_SHAPE_DATABASE_H

#include <sqlite3.h>

#include "core/context.h"
#include "core/memory.h"
#include "starguard/database.h"

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

void database_models_clear(starg_context *context, database_models *list);

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

/* ---- text ---- */

/* Copies text to the context's memory; NULL when out of memory. */
char *database_copy(starg_context *context, const char *text);

/* The file name at the end of a path. */
const char *database_name(const char *path);

#endif
