/* SPDX-License-Identifier: Apache-2.0 */
/* Database file: creation, opening, transactions.
 *
 * SQLite's application_id identifies our files, and user_version the schema. The journal is
 * SQLite's default, a rollback journal: it works in every writable folder, leaves a single file
 * when idle, and if a process dies in a transaction, the next one to open the file rolls back. */
#include "shape/database.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "core/file.h"

const char DATABASE_STAGE[] = "database";

enum { APPLICATION = 0x53544744, SCHEMA_VERSION = 1, WAIT_MILLISECONDS = 20, WAITS = 3000 };

static const char SCHEMA[] =
    "CREATE TABLE model (id INTEGER PRIMARY KEY, path TEXT NOT NULL, hash BLOB NOT NULL UNIQUE,"
    " vertices INTEGER NOT NULL, faces INTEGER NOT NULL) STRICT;"
    "CREATE TABLE signature (model INTEGER NOT NULL REFERENCES model (id) ON DELETE CASCADE,"
    " kind TEXT NOT NULL, version INTEGER NOT NULL, numbers BLOB NOT NULL,"
    " PRIMARY KEY (model, kind)) STRICT;";

/* ---- errors ---- */

/* Reports the failure of the last call on the connection. */
static starg_status fail_sqlite(starg_database *d) {
    starg_context *context = d->context;
    const char *reason = sqlite3_errmsg(d->handle);
    int error = sqlite3_system_errno(d->handle);
    switch (sqlite3_errcode(d->handle) & 0xff) {
    case SQLITE_NOMEM:
        return starg_fail_memory(context, DATABASE_STAGE);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        if (atomic_load(&context->cancelled))
            return starg_check_cancel(context, DATABASE_STAGE);
        return starg_fail(context, STARG_ERROR_WRITE, DATABASE_STAGE,
                          "'%s' is held by another process; try again later", d->path);
    case SQLITE_NOTADB:
        return starg_fail(context, STARG_ERROR_FORMAT, DATABASE_STAGE,
                          "'%s' is not a starguard database", d->path);
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:
    case SQLITE_CONSTRAINT:
        return starg_fail(context, STARG_ERROR_FORMAT, DATABASE_STAGE, "'%s' is damaged: %s",
                          d->path, reason);
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
        return starg_fail(context, STARG_ERROR_WRITE, DATABASE_STAGE,
                          "'%s' cannot be changed: %s; it and its folder must be writable", d->path,
                          reason);
    default:
        return starg_fail(context, STARG_ERROR_WRITE, DATABASE_STAGE,
                          "'%s' cannot be read or written: %s%s%s", d->path, reason,
                          error != 0 ? ": " : "", error != 0 ? strerror(error) : "");
    }
}

/* Waits while another process writes; gives up after a minute or when cancelled. */
static int wait_busy(void *user, int waits) {
    const starg_context *context = user;
    if (waits >= WAITS || atomic_load(&context->cancelled))
        return 0;
    nanosleep(&(struct timespec){.tv_nsec = WAIT_MILLISECONDS * 1000000L}, NULL);
    return 1;
}

/* ---- statements ---- */

starg_status database_run(starg_database *d, const char *sql) {
    return sqlite3_exec(d->handle, sql, NULL, NULL, NULL) == SQLITE_OK ? STARG_OK : fail_sqlite(d);
}

starg_status database_prepare(starg_database *d, const char *sql, sqlite3_stmt **out) {
    return sqlite3_prepare_v2(d->handle, sql, -1, out, NULL) == SQLITE_OK ? STARG_OK
                                                                          : fail_sqlite(d);
}

starg_status database_step(starg_database *d, sqlite3_stmt *statement, bool *row) {
    int result = sqlite3_step(statement);
    *row = result == SQLITE_ROW;
    if (*row)
        return STARG_OK;
    starg_status status = result == SQLITE_DONE ? STARG_OK : fail_sqlite(d);
    sqlite3_reset(statement);
    return status;
}

starg_status database_begin(starg_database *d) {
    return database_run(d, "BEGIN IMMEDIATE");
}

starg_status database_commit(starg_database *d) {
    return database_run(d, "COMMIT");
}

void database_roll_back(starg_database *d) {
    if (!sqlite3_get_autocommit(d->handle))
        sqlite3_exec(d->handle, "ROLLBACK", NULL, NULL, NULL);
}

char *database_copy(starg_context *context, const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = starg_allocate(context, size, 1);
    if (copy != NULL)
        memcpy(copy, text, size);
    return copy;
}

const char *database_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

/* ---- opening ---- */

/* Opens `file`; messages call it `path`. */
static starg_status connect(starg_context *context, const char *file, const char *path,
                            starg_database **out) {
    starg_status status = STARG_OK;
    starg_database *d = NULL;
    STARG_NEW_ZERO(context, DATABASE_STAGE, d, 1);
    d->context = context;
    d->path = database_copy(context, path);
    if (d->path == NULL) {
        status = starg_fail_memory(context, DATABASE_STAGE);
        goto done;
    }
    if (sqlite3_open_v2(file, &d->handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL) !=
        SQLITE_OK) {
        status = d->handle == NULL
                     ? starg_fail_memory(context, DATABASE_STAGE)
                     : starg_fail(context, STARG_ERROR_READ, DATABASE_STAGE, "cannot open '%s': %s",
                                  path, sqlite3_errmsg(d->handle));
        goto done;
    }
    sqlite3_busy_handler(d->handle, wait_busy, context);
    sqlite3_db_config(d->handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, (int *)NULL);
    *out = d;
done:
    if (status != STARG_OK)
        starg_database_close(d);
    return status;
}

static starg_status read_number(starg_database *d, const char *sql, int *value) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    bool row;
    TRY(database_prepare(d, sql, &statement));
    TRY(database_step(d, statement, &row));
    *value = row ? sqlite3_column_int(statement, 0) : 0;
    return STARG_OK;
}

static starg_status check_schema(starg_database *d) {
    int application, version, programs;
    TRY(read_number(d, "PRAGMA application_id", &application));
    TRY(read_number(d, "PRAGMA user_version", &version));
    /* a file may come from anywhere: reading its tables must not run code of its own */
    TRY(read_number(d, "SELECT count(*) FROM sqlite_schema WHERE type IN ('view', 'trigger')",
                    &programs));
    if (application != APPLICATION)
        return starg_fail(d->context, STARG_ERROR_FORMAT, DATABASE_STAGE,
                          "'%s' is not a starguard database", d->path);
    if (version != SCHEMA_VERSION)
        return starg_fail(d->context, STARG_ERROR_FORMAT, DATABASE_STAGE,
                          "'%s' has schema version %d, this program knows version %d; %s", d->path,
                          version, SCHEMA_VERSION,
                          version > SCHEMA_VERSION ? "use a newer starguard"
                                                   : "create a new one and add the models again");
    if (programs > 0)
        return starg_fail(d->context, STARG_ERROR_FORMAT, DATABASE_STAGE,
                          "'%s' has views or triggers, unlike starguard databases; not opened, "
                          "because they would run",
                          d->path);
    return STARG_OK;
}

starg_status starg_database_open(starg_context *context, const char *path, starg_database **out) {
    starg_status status = STARG_OK;
    starg_database *d = NULL;
    *out = NULL;
    if (access(path, R_OK) != 0)
        return errno == ENOENT
                   ? starg_fail(context, STARG_ERROR_READ, DATABASE_STAGE,
                                "no database '%s'; create it with 'starguard db create'", path)
                   : starg_fail(context, STARG_ERROR_READ, DATABASE_STAGE, "cannot open '%s': %s",
                                path, strerror(errno));
    STARG_TRY(connect(context, path, path, &d));
    STARG_TRY(check_schema(d));
    STARG_TRY(database_run(d, "PRAGMA foreign_keys = ON"));
    *out = d;
done:
    if (status != STARG_OK)
        starg_database_close(d);
    return status;
}

void starg_database_close(starg_database *d) {
    if (d == NULL)
        return;
    sqlite3_close(d->handle);
    RELEASE(d->path, d);
}

/* ---- creating ---- */

static starg_status write_schema(starg_database *d) {
    char marks[96];
    snprintf(marks, sizeof marks, "PRAGMA application_id = %d; PRAGMA user_version = %d",
             APPLICATION, SCHEMA_VERSION);
    TRY(database_begin(d));
    TRY(database_run(d, SCHEMA));
    TRY(database_run(d, DATABASE_SKETCHES));
    TRY(database_run(d, marks));
    return database_commit(d);
}

static starg_status fail_create(starg_context *context, const char *path, int error) {
    return error == EEXIST
               ? starg_fail(context, STARG_ERROR_WRITE, DATABASE_STAGE,
                            "'%s' already exists; databases are never overwritten", path)
               : starg_fail(context, STARG_ERROR_WRITE, DATABASE_STAGE, "cannot write '%s': %s",
                            path, strerror(error));
}

/* Unlike renaming, linking fails if the name is taken, so only one of two processes wins. File
 * systems without links use renaming. */
static starg_status put_in_place(starg_context *context, const char *made, const char *path) {
    if (link(made, path) == 0)
        return STARG_OK;
    int error = errno;
    if (error == EEXIST || access(path, F_OK) == 0)
        return fail_create(context, path, EEXIST);
    return rename(made, path) == 0 ? STARG_OK : fail_create(context, path, error);
}

static starg_status fill_file(starg_context *context, const char *name, const char *path) {
    starg_database *d = NULL;
    starg_status status = connect(context, name, path, &d);
    if (status == STARG_OK)
        status = write_schema(d);
    starg_database_close(d);
    if (status != STARG_OK)
        unlink(name);
    return status;
}

starg_status starg_database_create(starg_context *context, const char *path) {
    SCOPED char *made = NULL;
    if (access(path, F_OK) == 0)
        return fail_create(context, path, EEXIST);
    NEW(context, DATABASE_STAGE, made, strlen(path) + STARG_FILE_SUFFIX);
    int file = starg_file_temporary(path, made);
    if (file < 0)
        return fail_create(context, path, errno);
    close(file); /* SQLite accepts an empty file as an empty database */
    TRY(fill_file(context, made, path));
    starg_status status = put_in_place(context, made, path);
    unlink(made);
    return status;
}
