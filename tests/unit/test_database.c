/* SPDX-License-Identifier: Apache-2.0 */
/* The database: storing, finding, rejecting, and robustness. */
#include "starguard/database.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/rng.h"
#include "models.h"

enum { MODELS = 5 };

static char folder[64];

/* Paths in the scratch folder, a few at a time. */
static const char *path_of(const char *name) {
    static char paths[8][256];
    static size_t next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static const char *const names[MODELS] = {"box_1.off", "box_2.off", "hall_1.off", "hall_2.off",
                                          "lone.off"};

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/test_database_XXXXXX");
    if (mkdtemp(folder) == NULL)
        return 1;
    starg_context *context = test_context(1);
    for (size_t i = 0; i < MODELS; i++) {
        shape s = i < 2 ? shape_cube(5) : i < 4 ? shape_room() : shape_tetrahedron();
        if (i % 2 == 1)
            s.vertices[0] -= 0.125;
        starg_mesh *mesh = test_mesh_of(context, &s);
        test_ok(context, starg_mesh_write(context, mesh, path_of(names[i]), NULL));
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    test_context_free(context);
    return 0;
}

static int remove_folder(void **state) {
    (void)state;
    for (size_t i = 0; i < MODELS; i++)
        unlink(path_of(names[i]));
    unlink(path_of("models.db"));
    return rmdir(folder); /* fails if a test has left anything */
}

static starg_database *open_new(starg_context *context, const char *name) {
    starg_database *database = NULL;
    unlink(path_of(name));
    test_ok(context, starg_database_create(context, path_of(name)));
    test_ok(context, starg_database_open(context, path_of(name), &database));
    return database;
}

static starg_database_report *add(starg_context *context, starg_database *database,
                                  const char *const *files, size_t count) {
    starg_database_report *report = NULL;
    test_ok(context, starg_database_add(database, files, count, &report));
    assert_int_equal(report->count, count);
    assert_int_equal(report->added + report->known + report->refused, count);
    return report;
}

static starg_database *open_with_models(starg_context *context, const char *name) {
    starg_database *database = open_new(context, name);
    const char *files[MODELS];
    for (size_t i = 0; i < MODELS; i++)
        files[i] = path_of(names[i]);
    starg_database_report *report = add(context, database, files, MODELS);
    assert_int_equal(report->added, MODELS);
    starg_database_report_free(context, report);
    return database;
}

static char *read_bytes(const char *path, size_t *size) {
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    *size = (size_t)info.st_size;
    char *bytes = malloc(*size);
    FILE *file = fopen(path, "rb");
    assert_true(bytes != NULL && file != NULL);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static void write_bytes(const char *path, const char *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* A copy of a database of all models, which is created once. */
static starg_database *open_copy(starg_context *context, const char *name) {
    starg_database *database = NULL;
    size_t size;
    if (access(path_of("models.db"), F_OK) != 0)
        starg_database_close(open_with_models(context, "models.db"));
    char *bytes = read_bytes(path_of("models.db"), &size);
    write_bytes(path_of(name), bytes, size);
    free(bytes);
    test_ok(context, starg_database_open(context, path_of(name), &database));
    return database;
}

static size_t count_models(starg_context *context, starg_database *database) {
    starg_database_models *models = NULL;
    test_ok(context, starg_database_list(database, &models));
    size_t count = models->count;
    starg_database_models_free(context, models);
    return count;
}

/* ---- adding ---- */

static void added_known_refused(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_database *database = open_new(context, "a.db");
    const char *missing = "/nowhere/missing.off";
    const char *files[] = {path_of(names[0]), missing, path_of(names[1]), path_of(names[0]),
                           folder};
    starg_database_report *report = add(context, database, files, 5);
    const starg_database_outcome expected[] = {STARG_DATABASE_ADDED, STARG_DATABASE_REFUSED,
                                               STARG_DATABASE_ADDED, STARG_DATABASE_KNOWN,
                                               STARG_DATABASE_REFUSED};
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(report->results[i].outcome, expected[i]);
    assert_non_null(strstr(report->results[1].text, missing));
    assert_string_equal(report->results[3].text, files[0]);
    starg_database_report_free(context, report);

    report = add(context, database, files, 3);
    assert_int_equal(report->known, 2);
    starg_database_report_free(context, report);
    assert_int_equal(count_models(context, database), 2);

    const char *const standard[] = {"-"};
    assert_int_equal(starg_database_add(database, standard, 1, &report), STARG_ERROR_ARGUMENT);
    starg_database_close(database);
    unlink(path_of("a.db"));
    test_context_free(context);
}

/* The stored numbers are the models' signatures, for any number of threads. */
static void stored_signatures(void **state) {
    (void)state;
    starg_context *contexts[2] = {test_context(1), test_context(3)};
    unlink(path_of("models.db"));
    starg_database_close(open_with_models(contexts[1], "models.db"));
    starg_database *databases[2] = {open_with_models(contexts[0], "one.db"),
                                    open_copy(contexts[1], "three.db")};
    for (int k = 0; k < STARG_SIGNATURE_KINDS; k++) {
        starg_signature_kind kind = (starg_signature_kind)k;
        starg_database_models *models[2];
        for (size_t i = 0; i < 2; i++)
            test_ok(contexts[i], starg_database_signatures(databases[i], kind, &models[i]));
        for (size_t i = 0; i < MODELS; i++) {
            const starg_database_model *a = &models[0]->items[i], *b = &models[1]->items[i];
            starg_mesh *mesh = NULL;
            starg_signature *fresh = NULL;
            assert_string_equal(a->name, names[i]);
            assert_string_equal(a->hash, b->hash);
            assert_int_equal(a->id, b->id);
            assert_int_equal(a->signature->count, b->signature->count);
            assert_memory_equal(a->signature->numbers, b->signature->numbers,
                                8 * a->signature->count);
            if (i % STARG_SIGNATURE_KINDS != (size_t)k)
                continue; /* recomputes each kind for a model or two */
            test_ok(contexts[0], starg_mesh_read(contexts[0], a->path, &mesh));
            test_ok(contexts[0], starg_signature_create(contexts[0], mesh, kind, &fresh));
            assert_int_equal(a->vertices, starg_mesh_vertex_count(mesh));
            assert_int_equal(a->signature->count, fresh->count);
            assert_memory_equal(a->signature->numbers, fresh->numbers, 8 * fresh->count);
            starg_signature_free(contexts[0], fresh);
            starg_mesh_free(mesh);
        }
        for (size_t i = 0; i < 2; i++)
            starg_database_models_free(contexts[i], models[i]);
    }
    for (size_t i = 0; i < 2; i++) {
        starg_database_close(databases[i]);
        test_context_free(contexts[i]);
    }
    unlink(path_of("one.db"));
    unlink(path_of("three.db"));
}

/* Adding the file again recomputes signatures of another version. */
static void run_sql(const char *path, const char *sql) {
    sqlite3 *handle = NULL;
    assert_int_equal(sqlite3_open(path, &handle), SQLITE_OK);
    assert_int_equal(sqlite3_exec(handle, sql, NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(handle);
}

static void old_and_damaged_signatures(void **state) {
    (void)state;
    static const char *const harms[] = {
        "UPDATE signature SET version = 99 WHERE kind = 'd2' AND model = 4",
        "DELETE FROM signature WHERE kind = 'd2' AND model = 2",
        "UPDATE signature SET numbers = x'00' WHERE kind = 'd2' AND model = 3",
        "UPDATE signature SET numbers = zeroblob(0), version = 98 WHERE model = 1",
    };
    starg_context *context = test_context(1);
    starg_database *database = open_copy(context, "old.db");
    for (size_t i = 0; i < sizeof harms / sizeof *harms; i++) {
        starg_database_models *models = NULL;
        run_sql(path_of("old.db"), harms[i]);
        assert_int_equal(starg_database_signatures(database, STARG_SIGNATURE_D2, &models),
                         STARG_ERROR_FORMAT);
        assert_null(models);
        assert_non_null(strstr(starg_context_error(context)->message, "add its file again"));
        if (i == 2)
            run_sql(path_of("old.db"), "UPDATE signature SET version = 97 WHERE model = 3");
        const char *files[MODELS];
        for (size_t k = 0; k < MODELS; k++)
            files[k] = path_of(names[k]);
        starg_database_report *report = add(context, database, files, MODELS);
        assert_int_equal(report->known, MODELS);
        starg_database_report_free(context, report);
        test_ok(context, starg_database_signatures(database, STARG_SIGNATURE_D2, &models));
        assert_int_equal(models->count, MODELS);
        starg_database_models_free(context, models);
    }
    starg_database_close(database);
    unlink(path_of("old.db"));
    test_context_free(context);
}

/* A database with code that would run on reading or changing tables is not opened. */
static void views_and_triggers(void **state) {
    (void)state;
    static const char *const harms[] = {
        "CREATE VIEW more AS SELECT * FROM model",
        "CREATE TRIGGER all_of_them AFTER DELETE ON model BEGIN DELETE FROM model; END",
    };
    static const char *const cures[] = {"DROP VIEW more", "DROP TRIGGER all_of_them"};
    starg_context *context = test_context(1);
    starg_database_close(open_copy(context, "harm.db"));
    for (size_t i = 0; i < sizeof harms / sizeof *harms; i++) {
        starg_database *database = NULL;
        run_sql(path_of("harm.db"), harms[i]);
        assert_int_equal(starg_database_open(context, path_of("harm.db"), &database),
                         STARG_ERROR_FORMAT);
        assert_null(database);
        assert_non_null(strstr(starg_context_error(context)->message, "views or triggers"));
        run_sql(path_of("harm.db"), cures[i]);
        test_ok(context, starg_database_open(context, path_of("harm.db"), &database));
        starg_database_close(database);
    }
    unlink(path_of("harm.db"));
    test_context_free(context);
}

/* ---- query, remove ---- */

static int by_distance(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void queries(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_database *database = open_copy(context, "q.db");
    starg_database_models *all = NULL, *found = NULL;
    test_ok(context, starg_database_signatures(database, STARG_SIGNATURE_SHAPE_DNA, &all));
    for (size_t q = 0; q < MODELS; q++) {
        double distances[MODELS];
        for (size_t i = 0; i < MODELS; i++)
            test_ok(context, starg_signature_distance(context, all->items[q].signature,
                                                      all->items[i].signature, &distances[i]));
        qsort(distances, MODELS, sizeof *distances, by_distance);
        for (size_t wanted = 0; wanted <= MODELS + 2; wanted++) {
            test_ok(context,
                    starg_database_query(database, all->items[q].signature, wanted, &found));
            assert_int_equal(found->count, wanted < MODELS ? wanted : MODELS);
            for (size_t i = 0; i < found->count; i++)
                assert_true(found->items[i].distance == distances[i]);
            if (found->count > 0)
                assert_string_equal(found->items[0].name, all->items[q].name);
            starg_database_models_free(context, found);
        }
    }
    starg_database_models_free(context, all);
    starg_database_close(database);
    unlink(path_of("q.db"));
    test_context_free(context);
}

enum { CROWD = 400, CROWD_WANTED = 9 };

/* Numbers near those of `of`, valid for every kind but `paper`; every seventh is a copy of them. */
static void vary(const starg_signature *of, size_t item, uint8_t *bytes) {
    starg_rng rng = starg_rng_make(7, of->kind, item);
    double last = 0, all = item % 7 == 0 ? 1 : 0.9 + 0.2 * starg_rng_unit(&rng);
    for (size_t i = 0; i < of->count; i++) {
        double factor = item % 7 == 0 ? 1 : all * (0.98 + 0.04 * starg_rng_unit(&rng));
        double value = of->numbers[i] * factor;
        if (of->kind == STARG_SIGNATURE_SHAPE_DNA || (of->kind == STARG_SIGNATURE_STAR && i < 40))
            value = last = value > last ? value : last; /* spectra ascend */
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        for (int k = 0; k < 8; k++)
            bytes[8 * i + (size_t)k] = (uint8_t)(bits >> (8 * k));
    }
}

/* Adds CROWD models with signatures of one kind, without sketches. */
static void add_crowd(const char *path, const starg_database_models *known,
                      starg_signature_kind kind) {
    sqlite3 *handle = NULL;
    sqlite3_stmt *model = NULL, *signature = NULL;
    assert_int_equal(sqlite3_open(path, &handle), SQLITE_OK);
    sqlite3_exec(handle, "BEGIN", NULL, NULL, NULL);
    sqlite3_prepare_v2(handle, "INSERT INTO model VALUES (?, ?, randomblob(32), 1, 1)", -1, &model,
                       NULL);
    sqlite3_prepare_v2(handle, "INSERT INTO signature VALUES (?, ?, ?, ?)", -1, &signature, NULL);
    for (size_t i = 0; i < CROWD; i++) {
        const starg_signature *of = known->items[i % MODELS].signature;
        uint8_t bytes[8 * 512];
        char name[32];
        snprintf(name, sizeof name, "crowd_%zu.off", i);
        vary(of, i, bytes);
        sqlite3_bind_int64(model, 1, (sqlite3_int64)(100 + i));
        sqlite3_bind_text(model, 2, name, -1, SQLITE_STATIC);
        assert_int_equal(sqlite3_step(model), SQLITE_DONE);
        sqlite3_reset(model);
        sqlite3_bind_int64(signature, 1, (sqlite3_int64)(100 + i));
        sqlite3_bind_text(signature, 2, starg_signature_name(kind), -1, SQLITE_STATIC);
        sqlite3_bind_int(signature, 3, of->version);
        sqlite3_bind_blob(signature, 4, bytes, (int)(8 * of->count), SQLITE_STATIC);
        assert_int_equal(sqlite3_step(signature), SQLITE_DONE);
        sqlite3_reset(signature);
    }
    sqlite3_finalize(model);
    sqlite3_finalize(signature);
    assert_int_equal(sqlite3_exec(handle, "COMMIT", NULL, NULL, NULL), SQLITE_OK);
    sqlite3_close(handle);
}

typedef struct ranked {
    double distance;
    int64_t id;
} ranked;

static int by_rank(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    return x->distance != y->distance ? (x->distance > y->distance) - (x->distance < y->distance)
                                      : (x->id > y->id) - (x->id < y->id);
}

/* A query finds what comparing with every signature finds: a slow scan, ties by id. */
static void check_against_scan(starg_context *context, starg_database *database,
                               starg_signature_kind kind) {
    starg_database_models *all = NULL, *found = NULL;
    static ranked expected[MODELS + CROWD];
    test_ok(context, starg_database_signatures(database, kind, &all));
    for (size_t q = 0; q < all->count; q += all->count / 5) {
        for (size_t i = 0; i < all->count; i++) {
            expected[i].id = all->items[i].id;
            test_ok(context,
                    starg_signature_distance(context, all->items[q].signature,
                                             all->items[i].signature, &expected[i].distance));
        }
        qsort(expected, all->count, sizeof *expected, by_rank);
        test_ok(context,
                starg_database_query(database, all->items[q].signature, CROWD_WANTED, &found));
        assert_int_equal(found->count, CROWD_WANTED);
        for (size_t i = 0; i < found->count; i++) {
            assert_int_equal(found->items[i].id, expected[i].id);
            assert_true(found->items[i].distance == expected[i].distance);
        }
        starg_database_models_free(context, found);
    }
    starg_database_models_free(context, all);
}

static size_t count_sketches(const char *path) {
    sqlite3 *handle = NULL;
    sqlite3_stmt *statement = NULL;
    assert_int_equal(sqlite3_open(path, &handle), SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(handle, "SELECT count(*) FROM sketch", -1, &statement, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(statement), SQLITE_ROW);
    size_t count = (size_t)sqlite3_column_int64(statement, 0);
    sqlite3_finalize(statement);
    sqlite3_close(handle);
    return count;
}

/* Without the table of sketches (files of version 0.2), with sketches of a few models, and of all.
 */
static void queries_of_many(void **state) {
    (void)state;
    static const starg_signature_kind kinds[] = {STARG_SIGNATURE_D2, STARG_SIGNATURE_SHAPE_DNA,
                                                 STARG_SIGNATURE_STAR};
    starg_context *context = test_context(1);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        starg_database *database = open_copy(context, "many.db");
        starg_database_models *known = NULL;
        test_ok(context, starg_database_signatures(database, kinds[k], &known));
        assert_int_equal(count_sketches(path_of("many.db")), 3 * MODELS);
        add_crowd(path_of("many.db"), known, kinds[k]);
        check_against_scan(context, database, kinds[k]); /* the crowd has none */
        run_sql(path_of("many.db"), "DROP TABLE sketch");
        check_against_scan(context, database, kinds[k]);
        starg_database_report_free(context, add(context, database, NULL, 0));
        assert_int_equal(count_sketches(path_of("many.db")), 3 * MODELS + CROWD);
        check_against_scan(context, database, kinds[k]);
        starg_database_models_free(context, known);
        starg_database_close(database);
    }
    unlink(path_of("many.db"));
    test_context_free(context);
}

/* A replaced or removed signature takes its sketch along, whoever does it. */
static void sketches_follow(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_database *database = open_copy(context, "s.db");
    run_sql(path_of("s.db"), "PRAGMA foreign_keys = ON; INSERT OR REPLACE INTO signature SELECT "
                             "2, kind, version, numbers FROM signature WHERE model = 1");
    assert_int_equal(count_sketches(path_of("s.db")), 3 * (MODELS - 1));
    const char *const first[] = {"id:1"};
    test_ok(context, starg_database_remove(database, first, 1));
    assert_int_equal(count_sketches(path_of("s.db")), 3 * (MODELS - 2));
    starg_database_close(database);
    unlink(path_of("s.db"));
    test_context_free(context);
}

static void removal(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_database *database = open_copy(context, "r.db");
    const char *const unknown[] = {names[0], "unheard-of.off"};
    assert_int_equal(starg_database_remove(database, unknown, 2), STARG_ERROR_READ);
    assert_int_equal(count_models(context, database), MODELS); /* all or none */
    const char *const three[] = {names[0], path_of(names[1]), "id:3"};
    test_ok(context, starg_database_remove(database, three, 3));
    assert_int_equal(count_models(context, database), MODELS - 3);
    run_sql(path_of("r.db"), "UPDATE model SET path = '/x/twin.off' WHERE id = 4;"
                             "UPDATE model SET path = '/y/twin.off' WHERE id = 5");
    const char *const twin[] = {"twin.off"};
    assert_int_equal(starg_database_remove(database, twin, 1), STARG_ERROR_ARGUMENT);
    assert_int_equal(count_models(context, database), 2);
    /* signatures go with their models */
    const char *const rest[] = {"id:4", "/y/twin.off"};
    test_ok(context, starg_database_remove(database, rest, 2));
    run_sql(path_of("r.db"), "CREATE TABLE empty (x CHECK (x = 0));"
                             "INSERT INTO empty SELECT count(*) FROM signature; DROP TABLE empty");
    starg_database_close(database);
    unlink(path_of("r.db"));
    test_context_free(context);
}

/* ---- files that are not databases ---- */

static void expect_refusal(const char *name, starg_status expected, const char *phrase) {
    starg_context *context = test_context(1);
    starg_database *database = NULL;
    assert_int_equal(starg_database_open(context, path_of(name), &database), expected);
    assert_null(database);
    if (strstr(starg_context_error(context)->message, phrase) == NULL)
        fail_msg("'%s' lacks '%s'", starg_context_error(context)->message, phrase);
    test_context_free(context);
}

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(path_of(name), "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void no_databases(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    expect_refusal("missing.db", STARG_ERROR_READ, "db create");
    write_text("x.db", "");
    expect_refusal("x.db", STARG_ERROR_FORMAT, "not a starguard database");
    write_text("x.db", "This is a text and no database, though it is longer than a header of one, "
                       "which has a hundred bytes.");
    expect_refusal("x.db", STARG_ERROR_FORMAT, "not a starguard database");
    assert_int_equal(starg_database_create(context, path_of("x.db")), STARG_ERROR_WRITE);
    unlink(path_of("x.db"));
    run_sql(path_of("x.db"), "CREATE TABLE model (id)");
    expect_refusal("x.db", STARG_ERROR_FORMAT, "not a starguard database");
    unlink(path_of("x.db"));
    test_ok(context, starg_database_create(context, path_of("x.db")));
    run_sql(path_of("x.db"), "PRAGMA user_version = 2");
    expect_refusal("x.db", STARG_ERROR_FORMAT, "newer");
    run_sql(path_of("x.db"), "PRAGMA user_version = 0");
    expect_refusal("x.db", STARG_ERROR_FORMAT, "create a new one");
    unlink(path_of("x.db"));
    assert_int_equal(starg_database_create(context, "/nowhere/x.db"), STARG_ERROR_WRITE);
    expect_refusal("", STARG_ERROR_READ, folder);
    test_context_free(context);
}

/* Randomly overwritten bytes of a database: statuses, no crash. */
static void damaged_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_database_close(open_copy(context, "d.db"));
    size_t size, readable = 0;
    char *bytes = read_bytes(path_of("d.db"), &size), *harmed = malloc(size);
    assert_non_null(harmed);
    for (uint64_t round = 0; round < 200; round++) {
        starg_rng rng = starg_rng_make(2, round, 0);
        starg_database *database = NULL;
        starg_database_models *models = NULL;
        memcpy(harmed, bytes, size);
        for (int i = 0; i < 20; i++)
            harmed[starg_rng_below(&rng, round % 2 ? size : 600)] =
                (char)starg_rng_below(&rng, 256);
        write_bytes(path_of("d.db"), harmed, round % 5 == 0 ? size / 2 : size);
        if (starg_database_open(context, path_of("d.db"), &database) == STARG_OK) {
            starg_status status =
                starg_database_signatures(database, STARG_SIGNATURE_SHAPE_DNA, &models);
            readable += status == STARG_OK;
            assert_int_equal(status == STARG_OK, models != NULL);
            starg_database_models_free(context, models);
        }
        starg_database_close(database);
    }
    assert_true(readable > 5); /* some hit nothing relevant */
    free(bytes);
    free(harmed);
    unlink(path_of("d.db"));
    test_context_free(context);
}

/* ---- classes ---- */

static void classes_by_prefix(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_database_model items[] = {{.name = "a_b_1.off"},
                                    {.name = "a_b_2.off"},
                                    {.name = "a_1.off"},
                                    {.name = "plain"},
                                    {.name = "_x"}};
    const starg_database_models models = {5, items};
    starg_classes *classes = NULL;
    test_ok(context, starg_classes_by_prefix(context, &models, &classes));
    static const char *const expected[] = {"a_b", "a_b", "a", "plain", ""};
    assert_int_equal(classes->count, 4);
    for (size_t i = 0; i < 5; i++)
        assert_string_equal(classes->names[classes->class_of[i]], expected[i]);
    starg_classes_free(context, classes);
    test_context_free(context);
}

static void classes_of_a_file(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    char first[] = "one/big cat.off", second[] = "two/dog.off", third[] = "three/none.off";
    starg_database_model items[] = {{.path = first, .name = first + 4},
                                    {.path = second, .name = second + 4},
                                    {.path = third, .name = third + 6}};
    const starg_database_models models = {3, items};
    starg_classes *classes = NULL;
    write_text("c.txt", "# pets\n\n  big cat.off \t cat\r\ntwo/dog.off dog");
    test_ok(context, starg_classes_read(context, path_of("c.txt"), &models, &classes));
    assert_int_equal(classes->count, 2);
    assert_string_equal(classes->names[classes->class_of[0]], "cat");
    assert_string_equal(classes->names[classes->class_of[1]], "dog");
    assert_true(classes->class_of[2] == STARG_NO_CLASS);
    starg_classes_free(context, classes);
    static const char *const bad[] = {"horse.off horse\n", "dog.off dog\ntwo/dog.off wolf\n",
                                      "dog.off\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_text("c.txt", bad[i]);
        assert_int_equal(starg_classes_read(context, path_of("c.txt"), &models, &classes),
                         STARG_ERROR_FORMAT);
        assert_null(classes);
        assert_int_equal(starg_context_error(context)->indices[0], i == 1 ? 2 : 1);
    }
    unlink(path_of("c.txt"));
    test_context_free(context);
}

/* ---- memory ---- */

static void memory_may_give_out(void **state) {
    (void)state;
    size_t left = SIZE_MAX, failures = 0;
    starg_context *context = test_scarce_context(1, &left);
    starg_database *database = open_new(context, "m.db");
    const char *files[] = {path_of(names[4]), "/nowhere/missing.off"};
    for (;; failures += 1 + failures / 4) {
        starg_database_report *report = NULL;
        size_t before = starg_context_live_blocks(context);
        left = failures;
        starg_status status = starg_database_add(database, files, 2, &report);
        left = SIZE_MAX;
        starg_database_report_free(context, report);
        assert_int_equal(starg_context_live_blocks(context), before);
        if (status == STARG_OK)
            break;
        assert_int_equal(status, STARG_ERROR_MEMORY);
        assert_null(report);
        assert_int_equal(count_models(context, database), 0);
    }
    assert_true(failures > 15);
    for (failures = 0;; failures++) {
        starg_database_models *models = NULL;
        starg_classes *classes = NULL;
        size_t before = starg_context_live_blocks(context);
        left = failures;
        starg_status status =
            starg_database_signatures(database, STARG_SIGNATURE_SHAPE_DNA, &models);
        if (status == STARG_OK)
            status = starg_classes_by_prefix(context, models, &classes);
        left = SIZE_MAX;
        starg_classes_free(context, classes);
        starg_database_models_free(context, models);
        assert_int_equal(starg_context_live_blocks(context), before);
        if (status == STARG_OK)
            break;
        assert_int_equal(status, STARG_ERROR_MEMORY);
    }
    assert_true(failures > 5);
    starg_database_close(database);
    unlink(path_of("m.db"));
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(added_known_refused),
        cmocka_unit_test(stored_signatures),
        cmocka_unit_test(old_and_damaged_signatures),
        cmocka_unit_test(views_and_triggers),
        cmocka_unit_test(queries),
        cmocka_unit_test(queries_of_many),
        cmocka_unit_test(sketches_follow),
        cmocka_unit_test(removal),
        cmocka_unit_test(no_databases),
        cmocka_unit_test(damaged_files),
        cmocka_unit_test(classes_by_prefix),
        cmocka_unit_test(classes_of_a_file),
        cmocka_unit_test(memory_may_give_out),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
