/* SPDX-License-Identifier: Apache-2.0 */
/* Reads a database, and removes models from it.
 *
 * Numbers are stored as IEEE doubles, little-endian. */
#include <stdio.h>
#include <stdlib.h>

#include "shape/database.h"

static void clear_model(starg_database_model *model) {
    RELEASE(model->path);
    starg_signature_free(NULL, model->signature);
}

void database_models_clear(database_models *list) {
    for (size_t i = 0; i < list->count; i++)
        clear_model(&list->data[i]);
    RELEASE(list->data);
}

void starg_database_models_free(starg_context *context, starg_database_models *models) {
    (void)context;
    if (models == NULL)
        return;
    database_models_clear(&(database_models){.data = models->items, .count = models->count});
    RELEASE(models);
}

starg_status database_models_hand_over(starg_context *context, database_models *list,
                                       starg_database_models **out) {
    starg_database_models *models = NULL;
    NEW(context, DATABASE_STAGE, models, 1);
    *models = (starg_database_models){.count = list->count, .items = list->data};
    *list = (database_models){0};
    *out = models;
    return STARG_OK;
}

/* ---- rows ---- */

static void spell(const uint8_t *bytes, size_t count, char *out) {
    static const char digits[] = "0123456789abcdef";
    for (size_t i = 0; i < count; i++) {
        *out++ = digits[bytes[i] >> 4];
        *out++ = digits[bytes[i] & 15];
    }
    *out = '\0';
}

/* Columns: id, path, hash, vertices, faces. */
static starg_status read_model(starg_database *d, sqlite3_stmt *row, starg_database_model *model) {
    const char *path = (const char *)sqlite3_column_text(row, 1);
    const uint8_t *hash = sqlite3_column_blob(row, 2);
    *model = (starg_database_model){.id = sqlite3_column_int64(row, 0),
                                    .vertices = (size_t)sqlite3_column_int64(row, 3),
                                    .faces = (size_t)sqlite3_column_int64(row, 4)};
    if (path == NULL || hash == NULL || sqlite3_column_bytes(row, 2) != STARG_SHA256_BYTES)
        return starg_fail(d->context, STARG_ERROR_FORMAT, DATABASE_STAGE,
                          "'%s' is damaged: model %lld has no path or hash", d->path,
                          (long long)model->id);
    spell(hash, STARG_SHA256_BYTES, model->hash);
    model->path = database_copy(d->context, path);
    if (model->path == NULL)
        return starg_fail_memory(d->context, DATABASE_STAGE);
    model->name = database_name(model->path);
    return STARG_OK;
}

void database_read_doubles(const uint8_t *bytes, size_t count, double *out) {
    for (size_t i = 0; i < count; i++, bytes += 8) {
        uint64_t bits = 0;
        for (int k = 7; k >= 0; k--)
            bits = bits << 8 | bytes[k];
        memcpy(&out[i], &bits, sizeof bits);
    }
}

starg_status database_read_signature(starg_database *d, sqlite3_stmt *row, int first,
                                     starg_signature_kind kind, starg_signature **out) {
    starg_context *context = d->context;
    SCOPED double *numbers = NULL;
    const uint8_t *bytes = sqlite3_column_blob(row, first + 1);
    size_t count = (size_t)sqlite3_column_bytes(row, first + 1) / 8;
    NEW(context, DATABASE_STAGE, numbers, count);
    database_read_doubles(bytes, count, numbers);
    starg_status status =
        starg_signature_restore(context, kind, sqlite3_column_int(row, first), numbers, count, out);
    if (status != STARG_ERROR_FORMAT)
        return status;
    return starg_fail(context, status, DATABASE_STAGE,
                      "model %lld of '%s' has no usable %s signature; add its file again",
                      (long long)sqlite3_column_int64(row, 0), d->path, starg_signature_name(kind));
}

/* ---- lists ---- */

static int by_name(const void *a, const void *b) {
    const starg_database_model *x = a, *y = b;
    int order = strcmp(x->name, y->name);
    return order != 0 ? order : (x->id > y->id) - (x->id < y->id);
}

starg_status database_read_rows(starg_database *d, sqlite3_stmt *statement, int kind,
                                database_models *list) {
    SCOPED_BY(clear_model) starg_database_model model = {0};
    bool row;
    for (;;) {
        TRY(starg_check_cancel(d->context, DATABASE_STAGE));
        TRY(database_step(d, statement, &row));
        if (!row)
            break;
        TRY(read_model(d, statement, &model));
        if (kind >= 0)
            TRY(database_read_signature(d, statement, 5, (starg_signature_kind)kind,
                                        &model.signature));
        PUSH(d->context, DATABASE_STAGE, list, model);
        model = (starg_database_model){0};
    }
    return STARG_OK;
}

static starg_status read_list(starg_database *d, const char *sql, int kind,
                              starg_database_models **out) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    SCOPED_BY(database_models_clear) database_models list = {0};
    *out = NULL;
    TRY(database_prepare(d, sql, &statement));
    if (kind >= 0)
        sqlite3_bind_text(statement, 1, starg_signature_name((starg_signature_kind)kind), -1,
                          SQLITE_STATIC);
    TRY(database_read_rows(d, statement, kind, &list));
    if (list.count > 0)
        qsort(list.data, list.count, sizeof *list.data, by_name);
    return database_models_hand_over(d->context, &list, out);
}

starg_status starg_database_list(starg_database *d, starg_database_models **out) {
    return read_list(d, "SELECT id, path, hash, vertices, faces FROM model ORDER BY id", -1, out);
}

starg_status database_check_kind(starg_database *d, starg_signature_kind kind) {
    if (starg_signature_name(kind) != NULL)
        return STARG_OK;
    return starg_fail(d->context, STARG_ERROR_ARGUMENT, DATABASE_STAGE,
                      "there is no signature kind %d", (int)kind);
}

starg_status starg_database_signatures(starg_database *d, starg_signature_kind kind,
                                       starg_database_models **out) {
    starg_status status = database_check_kind(d, kind);
    *out = NULL;
    if (status != STARG_OK)
        return status;
    return read_list(
        d,
        "SELECT id, path, hash, vertices, faces, version, numbers FROM model LEFT JOIN "
        "signature ON model = id AND kind = ? ORDER BY id",
        (int)kind, out);
}

/* ---- removing ---- */

/* Does the word name the model: "id:N", a path, or a file name? */
static bool means(const starg_database_model *model, const char *word) {
    char text[32];
    snprintf(text, sizeof text, "id:%lld", (long long)model->id);
    return strcmp(word, text) == 0 || strcmp(word, model->path) == 0 ||
           strcmp(word, model->name) == 0;
}

static starg_status find_model(starg_database *d, const starg_database_models *models,
                               const char *word, int64_t *id) {
    size_t found = 0;
    for (size_t i = 0; i < models->count; i++) {
        if (!means(&models->items[i], word))
            continue;
        if (found++ > 0)
            return starg_fail(
                d->context, STARG_ERROR_ARGUMENT, DATABASE_STAGE,
                "'%s' is the name of several models, such as id:%lld and id:%lld; give an id", word,
                (long long)*id, (long long)models->items[i].id);
        *id = models->items[i].id;
    }
    if (found == 0)
        return starg_fail(d->context, STARG_ERROR_READ, DATABASE_STAGE,
                          "'%s' has no model '%s'; 'starguard db list' lists them", d->path, word);
    return STARG_OK;
}

starg_status starg_database_remove(starg_database *d, const char *const *words, size_t count) {
    starg_status status = STARG_OK;
    starg_database_models *models = NULL;
    sqlite3_stmt *statement = NULL;
    bool row;
    STARG_TRY(database_begin(d));
    STARG_TRY(starg_database_list(d, &models));
    STARG_TRY(database_prepare(d, "DELETE FROM model WHERE id = ?", &statement));
    for (size_t i = 0; i < count; i++) {
        int64_t id = 0;
        STARG_TRY(find_model(d, models, words[i], &id));
        sqlite3_bind_int64(statement, 1, id);
        STARG_TRY(database_step(d, statement, &row));
    }
    STARG_TRY(database_commit(d));
done:
    sqlite3_finalize(statement);
    database_roll_back(d);
    starg_database_models_free(d->context, models);
    return status;
}
