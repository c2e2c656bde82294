/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the database: connection, statements, and messages for SQLite's errors. */
#ifndef STARG_SHAPE_DATABASE_H
#define STARG_SHAPE_DATABASE_H

#include <sqlite3.h>

#include "core/context.h"
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

/* Copies text to the context's memory; NULL when out of memory. */
char *database_copy(starg_context *context, const char *text);

/* The file name at the end of a path. */
const char *database_name(const char *path);

#endif
