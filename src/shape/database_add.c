/* SPDX-License-Identifier: Apache-2.0 */
/* Adds models to a database.
 *
 * Stages: list the contents that are completely stored; describe the files
 * (shape/database_files.c), in parallel and in other processes if available (core/distribute.c);
 * store each file in order, several per transaction, as soon as it and all before it are described.
 *
 * Descriptions are computed outside of transactions: the database is locked for milliseconds only,
 * and two processes adding at once alternate. Contents that another process stored meanwhile, or
 * that occur twice in the list, violate the uniqueness of the hash and count as known.
 *
 * Cost: that of the signatures. */
#include <stdio.h>
#include <stdlib.h>

#include "shape/database.h"

enum { BATCH = 8 };

static const double PAUSE = 0.2; /* seconds between transactions: each waits for the disk */

typedef struct adding {
    database_files files; /* first: the loop's functions receive a pointer to it */
    starg_database *database;
    starg_context *context;
    database_digest *stored;
    size_t stored_files; /* files processed so far */
    double stored_at;    /* time of the last transaction, on starg_clock() */
    sqlite3_stmt *insert_model, *insert_signature, *insert_sketch, *find_model;
    starg_database_report *report;
} adding;

/* ---- stored signatures ---- */

/* Number of a model's stored signatures that are up to date. */
static starg_status prepare_stored(adding *a, sqlite3_stmt **out) {
    char sql[64 + 160 * STARG_SIGNATURE_KINDS] = "SELECT hash FROM model WHERE";
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        size_t used = strlen(sql);
        snprintf(sql + used, sizeof sql - used,
                 "%s EXISTS (SELECT 1 FROM signature WHERE model = id AND kind = '%s' AND version "
                 "= %d)",
                 kind > 0 ? " AND" : "", starg_signature_name((starg_signature_kind)kind),
                 starg_signature_version((starg_signature_kind)kind));
    }
    return database_prepare(a->database, sql, out);
}

static starg_status load_stored(adding *a) {
    starg_status status = STARG_OK;
    sqlite3_stmt *statement = NULL;
    STARG_ARRAY(database_digest) list = {0};
    bool row;
    STARG_TRY(prepare_stored(a, &statement));
    for (;;) {
        database_digest hash;
        STARG_TRY(database_step(a->database, statement, &row));
        if (!row)
            break;
        if (sqlite3_column_bytes(statement, 0) != sizeof hash)
            continue;
        memcpy(&hash, sqlite3_column_blob(statement, 0), sizeof hash);
        STARG_PUSH(a->context, DATABASE_STAGE, &list, hash);
    }
    if (list.count > 0)
        qsort(list.data, list.count, sizeof *list.data, database_by_digest);
done:
    sqlite3_finalize(statement);
    a->stored = list.data;
    a->files.stored = list.data;
    a->files.stored_count = list.count;
    return status;
}

/* ---- storing ---- */

static starg_status prepare_statements(adding *a) {
    TRY(database_prepare(a->database,
                         "INSERT INTO model (path, hash, vertices, faces) VALUES (?, ?, ?, ?)"
                         " ON CONFLICT (hash) DO NOTHING",
                         &a->insert_model));
    TRY(database_prepare(
        a->database,
        "INSERT OR REPLACE INTO signature (model, kind, version, numbers) VALUES (?, ?, ?, ?)",
        &a->insert_signature));
    TRY(database_prepare(a->database, DATABASE_INSERT_SKETCH, &a->insert_sketch));
    return database_prepare(a->database, "SELECT id, path FROM model WHERE hash = ?",
                            &a->find_model);
}

static starg_status note(adding *a, size_t item, starg_database_outcome outcome, const char *text) {
    starg_database_result *result = &a->report->results[item];
    result->outcome = outcome;
    if (text == NULL)
        return STARG_OK;
    starg_release(a->context, result->text);
    result->text = database_copy(a->context, text);
    return result->text != NULL ? STARG_OK : starg_fail_memory(a->context, DATABASE_STAGE);
}

static starg_status store_signatures(adding *a, int64_t model, const database_file *d) {
    sqlite3_stmt *s = a->insert_signature;
    bool row;
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        sqlite3_bind_int64(s, 1, model);
        sqlite3_bind_text(s, 2, starg_signature_name((starg_signature_kind)kind), -1,
                          SQLITE_STATIC);
        sqlite3_bind_int(s, 3, starg_signature_version((starg_signature_kind)kind));
        sqlite3_bind_blob64(s, 4, d->numbers[kind], d->sizes[kind], SQLITE_STATIC);
        TRY(database_step(a->database, s, &row));
        TRY(database_store_sketch(a->database, a->insert_sketch, model, (starg_signature_kind)kind,
                                  d->numbers[kind], d->sizes[kind]));
    }
    return STARG_OK;
}

/* Finds or inserts the model with this content; tells whether it is new. */
static starg_status store_model(adding *a, size_t item, bool *is_new, int64_t *id) {
    const database_file *d = &a->files.files[item];
    sqlite3_stmt *s = a->insert_model;
    bool row;
    sqlite3_bind_text(s, 1, a->files.names[item], -1, SQLITE_STATIC);
    sqlite3_bind_blob(s, 2, d->hash.bytes, sizeof d->hash.bytes, SQLITE_STATIC);
    sqlite3_bind_int64(s, 3, (int64_t)d->vertices);
    sqlite3_bind_int64(s, 4, (int64_t)d->faces);
    TRY(database_step(a->database, s, &row));
    *is_new = sqlite3_changes(a->database->handle) > 0;
    *id = sqlite3_last_insert_rowid(a->database->handle);
    return STARG_OK;
}

static starg_status note_known(adding *a, size_t item, int64_t *id) {
    starg_status status = STARG_OK;
    const database_file *d = &a->files.files[item];
    bool row;
    sqlite3_bind_blob(a->find_model, 1, d->hash.bytes, sizeof d->hash.bytes, SQLITE_STATIC);
    STARG_TRY(database_step(a->database, a->find_model, &row));
    *id = row ? sqlite3_column_int64(a->find_model, 0) : 0;
    const char *path = row ? (const char *)sqlite3_column_text(a->find_model, 1) : NULL;
    STARG_TRY(note(a, item, STARG_DATABASE_KNOWN, path != NULL ? path : ""));
done:
    sqlite3_reset(a->find_model);
    return status;
}

static starg_status store_item(adding *a, size_t item) {
    const database_file *d = &a->files.files[item];
    bool is_new = false;
    int64_t id;
    if (d->message != NULL)
        return note(a, item, STARG_DATABASE_REFUSED, d->message);
    if (!d->known)
        TRY(store_model(a, item, &is_new, &id));
    if (is_new)
        TRY(note(a, item, STARG_DATABASE_ADDED, d->warning));
    else
        TRY(note_known(a, item, &id));
    if (!d->known)
        TRY(store_signatures(a, id, d));
    return STARG_OK;
}

/* In one transaction. */
static starg_status store_until(adding *a, size_t end) {
    starg_status status = STARG_OK;
    STARG_TRY(database_begin(a->database));
    for (size_t i = a->stored_files; i < end; i++)
        STARG_TRY(store_item(a, i));
    STARG_TRY(database_commit(a->database));
    for (; a->stored_files < end; a->stored_files++)
        database_file_clear(&a->files.files[a->stored_files]);
done:
    if (status != STARG_OK)
        database_roll_back(a->database);
    return status;
}

/* ---- public function ---- */

/* A starg_parallel_loop's advance. */
static starg_status store_described(starg_context *context, void *shared, size_t described) {
    adding *a = shared;
    (void)context;
    bool due = described - a->stored_files >= BATCH && starg_clock() - a->stored_at >= PAUSE;
    if (!due && described < a->files.count)
        return STARG_OK;
    starg_status status = store_until(a, described);
    a->stored_at = starg_clock();
    return status;
}

static starg_status describe_and_store(adding *a) {
    SCOPED starg_bytes job = {0};
    const starg_parallel_remote remote = {
        .work = RANKS_DESCRIBE, .job = &job, .most = 1, .take = database_files_take};
    const starg_parallel_loop loop = {.stage = "add",
                                      .count = a->files.count,
                                      .shared = a,
                                      .item = database_files_describe,
                                      .make_scratch = database_files_scratch,
                                      .free_scratch = database_files_free_scratch,
                                      .advance = store_described,
                                      .remote = &remote};
    if (a->context->ranks != NULL)
        TRY(database_files_pack(a->context, &a->files, &job));
    return starg_parallel_in_time(a->context, &loop);
}

static void count_outcomes(starg_database_report *report) {
    for (size_t i = 0; i < report->count; i++) {
        report->added += report->results[i].outcome == STARG_DATABASE_ADDED;
        report->known += report->results[i].outcome == STARG_DATABASE_KNOWN;
        report->refused += report->results[i].outcome == STARG_DATABASE_REFUSED;
    }
}

starg_status starg_database_add(starg_database *database, const char *const *files, size_t count,
                                starg_database_report **out) {
    starg_context *context = database->context;
    starg_status status = STARG_OK;
    adding a = {
        .files = {.names = files, .count = count}, .database = database, .context = context};
    *out = NULL;
    for (size_t i = 0; i < count; i++)
        if (strcmp(files[i], "-") == 0)
            return starg_fail(context, STARG_ERROR_ARGUMENT, DATABASE_STAGE,
                              "a database takes files, which have names, not standard input");
    STARG_NEW_ZERO(context, DATABASE_STAGE, a.report, 1);
    a.report->count = count;
    STARG_NEW_ZERO(context, DATABASE_STAGE, a.report->results, count);
    STARG_NEW_ZERO(context, DATABASE_STAGE, a.files.files, count);
    STARG_TRY(database_add_sketches(database));
    STARG_TRY(load_stored(&a));
    STARG_TRY(prepare_statements(&a));
    STARG_TRY(describe_and_store(&a));
    count_outcomes(a.report);
    *out = a.report;
done:
    sqlite3_finalize(a.insert_model);
    sqlite3_finalize(a.insert_signature);
    sqlite3_finalize(a.insert_sketch);
    sqlite3_finalize(a.find_model);
    starg_release(context, a.stored);
    for (size_t i = a.stored_files; a.files.files != NULL && i < count; i++)
        database_file_clear(&a.files.files[i]);
    starg_release(context, a.files.files);
    if (status != STARG_OK)
        starg_database_report_free(context, a.report);
    return status;
}

void starg_database_report_free(starg_context *context, starg_database_report *report) {
    (void)context;
    if (report == NULL)
        return;
    for (size_t i = 0; report->results != NULL && i < report->count; i++)
        RELEASE(report->results[i].text);
    RELEASE(report->results, report);
}
