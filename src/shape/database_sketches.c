/* SPDX-License-Identifier: Apache-2.0 */
/* The database's table of sketches (sketch.c), from which queries choose what to read.
 *
 * Sketches of a kind lie next to each other in the file. The table can be missing, or lack models:
 * files of versions up to 0.2 have none, and such a program goes on adding signatures only. A
 * changed or removed signature takes its sketch along (ON DELETE CASCADE, which REPLACE obeys).
 *
 * Cost: that of reading all signatures when the table is made. */
#include "shape/database.h"
#include "shape/signature_kinds.h"

const char DATABASE_SKETCHES[] =
    "CREATE TABLE sketch (kind TEXT NOT NULL, model INTEGER NOT NULL, version INTEGER NOT NULL,"
    " sums BLOB NOT NULL, PRIMARY KEY (kind, model), FOREIGN KEY (model, kind) REFERENCES"
    " signature (model, kind) ON DELETE CASCADE) STRICT, WITHOUT ROWID;";

const char DATABASE_INSERT_SKETCH[] =
    "INSERT OR REPLACE INTO sketch (kind, model, version, sums) VALUES (?, ?, ?, ?)";

starg_status database_has_sketches(starg_database *d, bool *yes) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    TRY(database_prepare(d, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'sketch'",
                         &statement));
    return database_step(d, statement, yes);
}

starg_status database_store_sketch(starg_database *d, sqlite3_stmt *statement, int64_t model,
                                   starg_signature_kind kind, const uint8_t *bytes, size_t size) {
    const signature_method *method = signature_method_of(kind);
    SCOPED double *numbers = NULL;
    uint8_t stored[SKETCH_MOST_BYTES];
    sketch s;
    bool row;
    if (sketch_count(kind) == 0 || size != 8 * method->count)
        return STARG_OK;
    NEW(d->context, DATABASE_STAGE, numbers, method->count);
    database_read_doubles(bytes, method->count, numbers);
    if (method->check(numbers, method->count)) {
        sketch_make(kind, numbers, method->count, &s);
        sketch_store(&s, stored);
        sqlite3_bind_text(statement, 1, method->name, -1, SQLITE_STATIC);
        sqlite3_bind_int64(statement, 2, model);
        sqlite3_bind_int(statement, 3, method->version);
        sqlite3_bind_blob64(statement, 4, stored, 4 * s.count, SQLITE_STATIC);
        TRY(database_step(d, statement, &row));
    }
    return STARG_OK;
}

static starg_status add_kind(starg_database *d, sqlite3_stmt *insert, starg_signature_kind kind) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    bool row;
    TRY(database_prepare(d, "SELECT model, numbers FROM signature WHERE kind = ? AND version = ?",
                         &statement));
    sqlite3_bind_text(statement, 1, starg_signature_name(kind), -1, SQLITE_STATIC);
    sqlite3_bind_int(statement, 2, starg_signature_version(kind));
    for (;;) {
        TRY(starg_check_cancel(d->context, DATABASE_STAGE));
        TRY(database_step(d, statement, &row));
        if (!row)
            break;
        const uint8_t *bytes = sqlite3_column_blob(statement, 1);
        TRY(database_store_sketch(d, insert, sqlite3_column_int64(statement, 0), kind, bytes,
                                  (size_t)sqlite3_column_bytes(statement, 1)));
    }
    return STARG_OK;
}

starg_status database_add_sketches(starg_database *d) {
    starg_status status = STARG_OK;
    sqlite3_stmt *insert = NULL;
    bool there;
    STARG_TRY(database_has_sketches(d, &there));
    if (there)
        return STARG_OK;
    STARG_TRY(database_begin(d));
    STARG_TRY(database_has_sketches(d, &there)); /* another process may have been faster */
    if (!there) {
        STARG_TRY(database_run(d, DATABASE_SKETCHES));
        STARG_TRY(database_prepare(d, DATABASE_INSERT_SKETCH, &insert));
        for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
            STARG_TRY(add_kind(d, insert, (starg_signature_kind)kind));
    }
    STARG_TRY(database_commit(d));
done:
    sqlite3_finalize(insert);
    if (status != STARG_OK)
        database_roll_back(d);
    return status;
}
