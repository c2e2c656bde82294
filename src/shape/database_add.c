/* Adding models to a database.
 *
 * Stages: the contents that are stored whole; then, a batch of files at a time: read, hash and
 * describe them in parallel, and store the batch in one transaction in the order of the files.
 *
 * Descriptions are made outside of transactions: a database is locked for milliseconds only, and
 * two processes that add at once take turns. Contents that another process stored meanwhile, or
 * that stand twice in the list, meet the uniqueness of the hash and count as known.
 *
 * A worker has a context of its own (its errors are a file's, not the call's), which asks the
 * call's context whether to go on. It knows no time limit: one would change what is stored. When
 * the call's strikes, the batch under way is given up, and what was stored before stays.
 *
 * Cost: that of the signatures. */
#include <stdio.h>
#include <stdlib.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/sha256.h"
#include "shape/database.h"

enum { BATCH_PER_THREAD = 4, LEAST_BATCH = 8 };

typedef struct digest {
    uint8_t bytes[STARG_SHA256_BYTES];
} digest;

/* What is known of one file before it is stored. */
typedef struct description {
    starg_status status;
    char *message; /* why the file is refused */
    digest hash;
    bool known; /* stored, with all signatures */
    size_t vertices, faces;
    uint8_t *numbers[STARG_SIGNATURE_KINDS]; /* as they are stored */
    size_t sizes[STARG_SIGNATURE_KINDS];
} description;

typedef struct adding {
    starg_database *database;
    starg_context *context;
    const char *const *files;
    size_t count;
    digest *stored; /* ascending */
    size_t stored_count;
    size_t first, batch_size; /* the batch under way */
    description *batch;
    sqlite3_stmt *insert_model, *insert_signature, *find_model;
    starg_database_report *report;
} adding;

/* ---- what is stored ---- */

static int by_bytes(const void *a, const void *b) {
    return memcmp(a, b, sizeof(digest));
}

/* How many signatures a model has that need not be made anew. */
static starg_status prepare_stored(adding *a, sqlite3_stmt **out) {
    starg_status status = STARG_OK;
    char sql[64 + 160 * STARG_SIGNATURE_KINDS] = "SELECT hash FROM model WHERE";
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        size_t used = strlen(sql);
        snprintf(sql + used, sizeof sql - used,
                 "%s EXISTS (SELECT 1 FROM signature WHERE model = id AND kind = '%s' AND version "
                 "= %d)",
                 kind > 0 ? " AND" : "", starg_signature_name((starg_signature_kind)kind),
                 starg_signature_version((starg_signature_kind)kind));
    }
    STARG_TRY(database_prepare(a->database, sql, out));
done:
    return status;
}

static starg_status load_stored(adding *a) {
    starg_status status = STARG_OK;
    sqlite3_stmt *statement = NULL;
    STARG_ARRAY(digest) list = {0};
    bool row;
    STARG_TRY(prepare_stored(a, &statement));
    for (;;) {
        digest hash;
        STARG_TRY(database_step(a->database, statement, &row));
        if (!row)
            break;
        if (sqlite3_column_bytes(statement, 0) != sizeof hash)
            continue;
        memcpy(&hash, sqlite3_column_blob(statement, 0), sizeof hash);
        STARG_PUSH(a->context, DATABASE_STAGE, &list, hash);
    }
    if (list.count > 0)
        qsort(list.data, list.count, sizeof *list.data, by_bytes);
done:
    sqlite3_finalize(statement);
    a->stored = list.data;
    a->stored_count = list.count;
    return status;
}

/* ---- describing ---- */

static bool go_on(void *user, const char *stage, double fraction) {
    const starg_context *parent = user;
    (void)stage, (void)fraction;
    return !atomic_load(&parent->cancelled) && !starg_time_is_over(parent);
}

static starg_status make_worker(starg_context *context, void *shared, void **scratch) {
    starg_context *worker = NULL;
    starg_context_options options;
    (void)shared;
    starg_context_options_default(&options);
    options.allocator = context->allocator;
    options.threads = 1;
    options.seed = context->seed;
    options.progress = go_on;
    options.progress_user = context;
    starg_status status = starg_context_create(&options, &worker);
    *scratch = worker;
    return status;
}

static void free_worker(starg_context *context, void *scratch) {
    (void)context;
    starg_context_free(scratch);
}

/* The least significant byte first, whatever the machine does. */
static starg_status keep_numbers(starg_context *context, const starg_signature *from,
                                 description *d) {
    starg_status status = STARG_OK;
    uint8_t *bytes = NULL;
    STARG_NEW(context, DATABASE_STAGE, bytes, 8 * from->count);
    for (size_t i = 0; i < from->count; i++) {
        uint64_t bits;
        memcpy(&bits, &from->numbers[i], sizeof bits);
        for (size_t k = 0; k < 8; k++)
            bytes[8 * i + k] = (uint8_t)(bits >> (8 * k));
    }
    d->numbers[from->kind] = bytes;
    d->sizes[from->kind] = 8 * from->count;
done:
    return status;
}

static starg_status describe_mesh(starg_context *context, starg_context *worker,
                                  const starg_mesh *mesh, description *d) {
    starg_status status = STARG_OK;
    starg_signature *signatures[STARG_SIGNATURE_KINDS] = {NULL};
    d->vertices = starg_mesh_vertex_count(mesh);
    d->faces = starg_mesh_face_count(mesh);
    STARG_TRY(starg_signature_create_all(worker, mesh, signatures));
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        STARG_TRY(keep_numbers(context, signatures[kind], d));
done:
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        starg_signature_free(worker, signatures[kind]);
    return status;
}

static starg_status describe_file(const adding *a, starg_context *worker, const char *file,
                                  description *d) {
    starg_status status = STARG_OK;
    starg_mesh *mesh = NULL;
    char *bytes = NULL;
    size_t size = 0;
    STARG_TRY(starg_file_read(worker, DATABASE_STAGE, file, &bytes, &size));
    starg_sha256(bytes, size, d->hash.bytes);
    d->known = a->stored_count > 0 &&
               bsearch(&d->hash, a->stored, a->stored_count, sizeof *a->stored, by_bytes) != NULL;
    if (d->known)
        goto done;
    STARG_TRY(starg_mesh_read_memory(worker, bytes, size, file, &mesh));
    STARG_TRY(describe_mesh(a->context, worker, mesh, d));
done:
    starg_mesh_free(mesh);
    starg_release(worker, bytes);
    return status;
}

/* A failure that is the file's is kept for the report; others end the call. */
static starg_status describe_item(starg_context *context, void *shared, void *scratch,
                                  size_t item) {
    const adding *a = shared;
    description *d = &a->batch[item];
    const char *file = a->files[a->first + item];
    d->status = describe_file(a, scratch, file, d);
    if (d->status == STARG_ERROR_CANCELLED && !atomic_load(&context->cancelled))
        d->status = STARG_ERROR_TIME;
    if (d->status == STARG_OK || d->status == STARG_ERROR_MEMORY ||
        d->status == STARG_ERROR_CANCELLED || d->status == STARG_ERROR_TIME)
        return d->status;
    const char *message = starg_context_error(scratch)->message;
    d->message = database_copy(context, message);
    return d->message != NULL ? STARG_OK : STARG_ERROR_MEMORY;
}

/* ---- storing ---- */

static starg_status prepare_statements(adding *a) {
    starg_status status = STARG_OK;
    STARG_TRY(database_prepare(a->database,
                               "INSERT INTO model (path, hash, vertices, faces) VALUES (?, ?, ?, ?)"
                               " ON CONFLICT (hash) DO NOTHING",
                               &a->insert_model));
    STARG_TRY(database_prepare(
        a->database,
        "INSERT OR REPLACE INTO signature (model, kind, version, numbers) VALUES (?, ?, ?, ?)",
        &a->insert_signature));
    STARG_TRY(
        database_prepare(a->database, "SELECT id, path FROM model WHERE hash = ?", &a->find_model));
done:
    return status;
}

static starg_status note(adding *a, size_t item, starg_database_outcome outcome, const char *text) {
    starg_database_result *result = &a->report->results[a->first + item];
    result->outcome = outcome;
    if (text == NULL)
        return STARG_OK;
    starg_release(a->context, result->text);
    result->text = database_copy(a->context, text);
    return result->text != NULL ? STARG_OK : starg_fail_memory(a->context, DATABASE_STAGE);
}

static starg_status store_signatures(adding *a, int64_t model, const description *d) {
    starg_status status = STARG_OK;
    sqlite3_stmt *s = a->insert_signature;
    bool row;
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        sqlite3_bind_int64(s, 1, model);
        sqlite3_bind_text(s, 2, starg_signature_name((starg_signature_kind)kind), -1,
                          SQLITE_STATIC);
        sqlite3_bind_int(s, 3, starg_signature_version((starg_signature_kind)kind));
        sqlite3_bind_blob64(s, 4, d->numbers[kind], d->sizes[kind], SQLITE_STATIC);
        STARG_TRY(database_step(a->database, s, &row));
    }
done:
    return status;
}

/* The model of this content, and whether it was there before. */
static starg_status store_model(adding *a, size_t item, bool *is_new, int64_t *id) {
    starg_status status = STARG_OK;
    const description *d = &a->batch[item];
    sqlite3_stmt *s = a->insert_model;
    bool row;
    sqlite3_bind_text(s, 1, a->files[a->first + item], -1, SQLITE_STATIC);
    sqlite3_bind_blob(s, 2, d->hash.bytes, sizeof d->hash.bytes, SQLITE_STATIC);
    sqlite3_bind_int64(s, 3, (int64_t)d->vertices);
    sqlite3_bind_int64(s, 4, (int64_t)d->faces);
    STARG_TRY(database_step(a->database, s, &row));
    *is_new = sqlite3_changes(a->database->handle) > 0;
    *id = sqlite3_last_insert_rowid(a->database->handle);
done:
    return status;
}

static starg_status note_known(adding *a, size_t item, int64_t *id) {
    starg_status status = STARG_OK;
    const description *d = &a->batch[item];
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
    const description *d = &a->batch[item];
    starg_status status = STARG_OK;
    bool is_new = false;
    int64_t id;
    if (d->message != NULL)
        return note(a, item, STARG_DATABASE_REFUSED, d->message);
    if (!d->known)
        STARG_TRY(store_model(a, item, &is_new, &id));
    if (is_new)
        STARG_TRY(note(a, item, STARG_DATABASE_ADDED, NULL));
    else
        STARG_TRY(note_known(a, item, &id));
    if (!d->known)
        STARG_TRY(store_signatures(a, id, d));
done:
    return status;
}

static starg_status store_batch(adding *a) {
    starg_status status = STARG_OK;
    STARG_TRY(database_begin(a->database));
    for (size_t i = 0; i < a->batch_size; i++)
        STARG_TRY(store_item(a, i));
    STARG_TRY(database_commit(a->database));
done:
    if (status != STARG_OK)
        database_roll_back(a->database);
    return status;
}

/* ---- all of it ---- */

static void clear_batch(adding *a) {
    for (size_t i = 0; i < a->batch_size; i++) {
        starg_release(a->context, a->batch[i].message);
        for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
            starg_release(a->context, a->batch[i].numbers[kind]);
        a->batch[i] = (description){0};
    }
}

static starg_status add_batches(adding *a, size_t most) {
    starg_status status = STARG_OK;
    starg_progress_begin(a->context, "add");
    for (a->first = 0; a->first < a->count; a->first += a->batch_size) {
        a->batch_size = a->count - a->first < most ? a->count - a->first : most;
        const starg_parallel_loop loop = {.stage = "add",
                                          .count = a->batch_size,
                                          .shared = a,
                                          .item = describe_item,
                                          .make_scratch = make_worker,
                                          .free_scratch = free_worker,
                                          .stop_at_deadline = true,
                                          .before = a->first,
                                          .whole = a->count};
        STARG_TRY(starg_parallel_for(a->context, &loop));
        STARG_TRY(store_batch(a));
        clear_batch(a);
    }
    starg_progress_end(a->context);
done:
    clear_batch(a);
    return status;
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
    size_t most = BATCH_PER_THREAD * (size_t)context->threads;
    adding a = {.database = database, .context = context, .files = files, .count = count};
    *out = NULL;
    for (size_t i = 0; i < count; i++)
        if (strcmp(files[i], "-") == 0)
            return starg_fail(context, STARG_ERROR_ARGUMENT, DATABASE_STAGE,
                              "a database takes files, which have names, not standard input");
    if (most < LEAST_BATCH)
        most = LEAST_BATCH;
    STARG_NEW_ZERO(context, DATABASE_STAGE, a.report, 1);
    a.report->count = count;
    STARG_NEW_ZERO(context, DATABASE_STAGE, a.report->results, count);
    STARG_NEW_ZERO(context, DATABASE_STAGE, a.batch, most);
    STARG_TRY(load_stored(&a));
    STARG_TRY(prepare_statements(&a));
    STARG_TRY(add_batches(&a, most));
    count_outcomes(a.report);
    *out = a.report;
done:
    sqlite3_finalize(a.insert_model);
    sqlite3_finalize(a.insert_signature);
    sqlite3_finalize(a.find_model);
    starg_release(context, a.stored);
    starg_release(context, a.batch);
    if (status != STARG_OK)
        starg_database_report_free(context, a.report);
    return status;
}

void starg_database_report_free(starg_context *context, starg_database_report *report) {
    if (report == NULL)
        return;
    for (size_t i = 0; report->results != NULL && i < report->count; i++)
        starg_release(context, report->results[i].text);
    starg_release(context, report->results);
    starg_release(context, report);
}
