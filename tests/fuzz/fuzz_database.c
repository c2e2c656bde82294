/* SPDX-License-Identifier: Apache-2.0 */
/* A database file of any bytes or, with FUZZ_ROWS, a sound SQLite file with any rows, in tables of
 * our columns but of any types. Opening, listing, asking for signatures, querying and removing give
 * what they promise, or an error that says something. */
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/database.h"
#include "support.h"

/* ---- rows ---- */

static void run(sqlite3 *handle, const char *sql) {
    fuzz_require(sqlite3_exec(handle, sql, NULL, NULL, NULL) == SQLITE_OK, sql);
}

/* A value of any type; blobs are often some doubles. */
static void bind_value(sqlite3_stmt *statement, int index, fuzz_input *in) {
    unsigned char bytes[512];
    uint32_t kind = fuzz_below(in, 6);
    int size = (int)(kind == 5 ? 8 * fuzz_below(in, 65) : fuzz_below(in, 80));
    if (kind >= 3)
        for (int i = 0; i < size; i++)
            bytes[i] = kind == 5 && i % 8 == 7 ? 0x3f : (unsigned char)fuzz_byte(in);
    switch (kind) {
    case 0:
        sqlite3_bind_null(statement, index);
        break;
    case 1:
        sqlite3_bind_int64(statement, index, (sqlite3_int64)fuzz_byte(in) - 1);
        break;
    case 2:
        sqlite3_bind_double(statement, index, fuzz_double(in));
        break;
    case 3:
        sqlite3_bind_text(statement, index, (const char *)bytes, size, SQLITE_TRANSIENT);
        break;
    default:
        sqlite3_bind_blob(statement, index, bytes, size, SQLITE_TRANSIENT);
    }
}

static void add_model(sqlite3 *handle, sqlite3_int64 id, fuzz_input *in) {
    sqlite3_stmt *statement = NULL;
    unsigned char hash[32] = {(unsigned char)id};
    sqlite3_prepare_v2(handle, "INSERT INTO model VALUES (?, ?, ?, ?, ?)", -1, &statement, NULL);
    sqlite3_bind_int64(statement, 1, id);
    sqlite3_bind_text(statement, 2, "a/cat_1.off", -1, SQLITE_STATIC);
    sqlite3_bind_blob(statement, 3, hash, sizeof hash, SQLITE_TRANSIENT);
    for (int i = 4; i <= 5; i++)
        sqlite3_bind_int64(statement, i, fuzz_byte(in));
    for (uint32_t changes = fuzz_below(in, 4); changes > 1; changes--)
        bind_value(statement, (int)(2 + fuzz_below(in, 4)), in);
    sqlite3_step(statement); /* a constraint may refuse it */
    sqlite3_finalize(statement);
}

static void add_signature(sqlite3 *handle, sqlite3_int64 model, fuzz_input *in) {
    static const char *const sql = "INSERT INTO signature VALUES (?, ?, ?, ?)";
    starg_signature_kind kind = (starg_signature_kind)fuzz_below(in, STARG_SIGNATURE_KINDS);
    sqlite3_stmt *statement = NULL;
    sqlite3_prepare_v2(handle, sql, -1, &statement, NULL);
    sqlite3_bind_int64(statement, 1, model);
    sqlite3_bind_text(statement, 2, starg_signature_name(kind), -1, SQLITE_STATIC);
    sqlite3_bind_int(statement, 3, starg_signature_version(kind));
    bind_value(statement, 4, in);
    for (uint32_t changes = fuzz_below(in, 4); changes > 1; changes--)
        bind_value(statement, (int)(1 + fuzz_below(in, 3)), in);
    sqlite3_step(statement);
    sqlite3_finalize(statement);
}

static void make_tables(sqlite3 *handle, bool strict, bool wide) {
    run(handle, wide ? "PRAGMA encoding = 'UTF-16'" : "PRAGMA encoding = 'UTF-8'");
    run(handle, "PRAGMA page_size = 512; PRAGMA application_id = 1398032196;"
                "PRAGMA user_version = 1;");
    run(handle, strict
                    ? "CREATE TABLE model (id INTEGER PRIMARY KEY, path TEXT NOT NULL, hash BLOB "
                      "NOT NULL UNIQUE, vertices INTEGER NOT NULL, faces INTEGER NOT NULL) "
                      "STRICT; CREATE TABLE signature (model INTEGER NOT NULL REFERENCES model "
                      "(id) ON DELETE CASCADE, kind TEXT NOT NULL, version INTEGER NOT NULL, "
                      "numbers BLOB NOT NULL, PRIMARY KEY (model, kind)) STRICT;"
                    : "CREATE TABLE model (id, path, hash, vertices, faces);"
                      "CREATE TABLE signature (model, kind, version, numbers);");
}

/* A file with rows that the bytes choose. */
static const char *file_of_rows(const unsigned char *data, size_t size) {
    fuzz_input in = {data, size};
    sqlite3 *handle = NULL;
    sqlite3_int64 length = 0;
    fuzz_require(sqlite3_open(":memory:", &handle) == SQLITE_OK, "SQLite works");
    uint32_t kind = fuzz_below(&in, 8);
    make_tables(handle, kind % 4 == 0, kind > 5);
    sqlite3_int64 models = fuzz_below(&in, 4);
    for (sqlite3_int64 id = 1; id <= models; id++) {
        add_model(handle, id, &in);
        for (uint32_t count = fuzz_below(&in, 4); count > 0; count--)
            add_signature(handle, id, &in);
    }
    unsigned char *bytes = sqlite3_serialize(handle, "main", &length, 0);
    fuzz_require(bytes != NULL, "SQLite can write to memory");
    const char *path = fuzz_file(".db", bytes, (size_t)length);
    sqlite3_free(bytes);
    sqlite3_close(handle);
    return path;
}

/* ---- use ---- */

/* Reading may find damage, some of which SQLite calls a lack of memory, and removing may find
 * nothing to remove. */
static bool went_well(const starg_context *context, starg_status status) {
    const starg_error *error = starg_context_error(context);
    if (status == STARG_OK)
        return true;
    fuzz_require(status == STARG_ERROR_FORMAT || status == STARG_ERROR_READ ||
                     status == STARG_ERROR_WRITE || status == STARG_ERROR_ARGUMENT ||
                     status == STARG_ERROR_MEMORY,
                 "a damaged database is an error of the file");
    fuzz_require(error->status == status && error->message[0] != '\0', "there is a message");
    return false;
}

static void check_models(const starg_database_models *models) {
    for (size_t i = 0; i < models->count; i++) {
        const starg_database_model *model = &models->items[i];
        size_t path = strlen(model->path);
        fuzz_require(model->name >= model->path && model->name <= model->path + path,
                     "names are ends of paths");
        fuzz_require(strspn(model->hash, "0123456789abcdef") == 64 && model->hash[64] == '\0',
                     "hashes are hexadecimal");
    }
}

/* The nearest come first, each at the distance that its signature has. */
static void check_query(starg_context *context, starg_database *database,
                        const starg_database_models *all) {
    starg_database_models *found = NULL;
    const starg_signature *wanted = all->items[0].signature;
    if (!went_well(context, starg_database_query(database, wanted, all->count, &found)))
        return;
    fuzz_require(found->count == all->count, "a query for all finds all");
    for (size_t i = 0; i < found->count; i++) {
        double distance = -1;
        fuzz_require(i == 0 || !(found->items[i - 1].distance > found->items[i].distance),
                     "the nearest come first");
        for (size_t j = 0; j < all->count; j++)
            if (all->items[j].id == found->items[i].id)
                fuzz_require_ok(
                    context,
                    starg_signature_distance(context, wanted, all->items[j].signature, &distance),
                    "signatures of a kind compare");
        fuzz_require(distance == found->items[i].distance, "distances are those of the signatures");
    }
    starg_database_models_free(context, found);
}

static void use(starg_context *context, starg_database *database) {
    static const char *const words[] = {"id:1"};
    starg_database_models *models = NULL;
    if (went_well(context, starg_database_list(database, &models)))
        check_models(models);
    starg_database_models_free(context, models);
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++) {
        starg_signature_kind wanted = (starg_signature_kind)kind;
        if (went_well(context, starg_database_signatures(database, wanted, &models)) &&
            models->count > 0) {
            check_models(models);
            check_query(context, database, models);
        }
        starg_database_models_free(context, models);
    }
    went_well(context, starg_database_remove(database, words, 1));
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = fuzz_context();
    starg_database *database = NULL;
    const char *path = FUZZ_ROWS ? file_of_rows(data, size) : fuzz_file(".db", data, size);
    if (went_well(context, starg_database_open(context, path, &database)))
        use(context, database);
    starg_database_close(database);
    fuzz_context_end(context);
    return 0;
}
