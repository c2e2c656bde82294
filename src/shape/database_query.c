/* SPDX-License-Identifier: Apache-2.0 */
/* Nearest models: filter and refine [FRM94].
 *
 * Stages: bound the distance of each model from below by its sketch (sketch.c); a model without one
 * has the bound 0. Take models by ascending bound, read their signatures and keep the nearest,
 * until the next bound exceeds the distance of the last of these.
 *
 * Invariants: the result is that of reading all signatures: by ascending distance, ties by id.
 * A model without a usable signature is reported, because it has no sketch either.
 *
 * Cost: for n models of which m are read, n short rows in the order of the file, n log n to sort
 * them, and m random accesses. */
#include <stdlib.h>

#include "shape/database.h"
#include "shape/signature_kinds.h"

typedef struct candidate {
    double distance; /* or its lower bound */
    int64_t id;
} candidate;

typedef STARG_ARRAY(candidate) candidates;

static bool before(const candidate *a, const candidate *b) {
    return a->distance < b->distance || (a->distance == b->distance && a->id < b->id);
}

static int by_distance(const void *left, const void *right) {
    const candidate *a = left, *b = right;
    return before(b, a) - before(a, b);
}

/* ---- bounds ---- */

static const char NO_SKETCHES[] = "SELECT id FROM model";
static const char LACKING[] =
    "SELECT id FROM model WHERE id NOT IN (SELECT model FROM sketch WHERE kind = ?)";

/* Adds the models of a statement, whose first column is the id, with the bound 0. */
static starg_status add_unbounded(starg_database *d, const char *sql, starg_signature_kind kind,
                                  candidates *list) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    bool row;
    TRY(database_prepare(d, sql, &statement));
    if (sqlite3_bind_parameter_count(statement) > 0)
        sqlite3_bind_text(statement, 1, starg_signature_name(kind), -1, SQLITE_STATIC);
    for (;;) {
        TRY(starg_check_cancel(d->context, DATABASE_STAGE));
        TRY(database_step(d, statement, &row));
        if (!row)
            break;
        const candidate c = {.id = sqlite3_column_int64(statement, 0)};
        PUSH(d->context, DATABASE_STAGE, list, c);
    }
    return STARG_OK;
}

static starg_status add_bounded(starg_database *d, const starg_signature *wanted,
                                candidates *list) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    size_t count = sketch_count(wanted->kind);
    sketch own, other;
    bool row;
    sketch_make(wanted->kind, wanted->numbers, wanted->count, &own);
    TRY(database_prepare(d, "SELECT model, version, sums FROM sketch WHERE kind = ?", &statement));
    sqlite3_bind_text(statement, 1, starg_signature_name(wanted->kind), -1, SQLITE_STATIC);
    for (;;) {
        TRY(starg_check_cancel(d->context, DATABASE_STAGE));
        TRY(database_step(d, statement, &row));
        if (!row)
            break;
        candidate c = {.id = sqlite3_column_int64(statement, 0)};
        if (sqlite3_column_int(statement, 1) == wanted->version &&
            sqlite3_column_bytes(statement, 2) == (int)(4 * count)) {
            sketch_load(sqlite3_column_blob(statement, 2), count, &other);
            c.distance = sketch_bound(wanted->kind, &own, &other);
        }
        PUSH(d->context, DATABASE_STAGE, list, c);
    }
    return STARG_OK;
}

/* All models, by ascending bound. */
static starg_status bound_models(starg_database *d, const starg_signature *wanted, size_t count,
                                 candidates *list) {
    bool sketched = false;
    if (sketch_count(wanted->kind) > 0)
        TRY(database_has_sketches(d, &sketched));
    if (sketched)
        TRY(add_bounded(d, wanted, list));
    if (list->count < count)
        TRY(add_unbounded(d, sketched ? LACKING : NO_SKETCHES, wanted->kind, list));
    if (list->count > 0)
        qsort(list->data, list->count, sizeof *list->data, by_distance);
    return STARG_OK;
}

/* ---- distances ---- */

/* Keeps the nearest sorted, at most `capacity` of them. */
static void consider(candidates *nearest, size_t capacity, candidate c) {
    if (nearest->count == capacity && !before(&c, &nearest->data[capacity - 1]))
        return;
    size_t place = nearest->count < capacity ? nearest->count++ : capacity - 1;
    for (; place > 0 && before(&c, &nearest->data[place - 1]); place--)
        nearest->data[place] = nearest->data[place - 1];
    nearest->data[place] = c;
}

static starg_status measure(starg_database *d, sqlite3_stmt *statement,
                            const starg_signature *wanted, candidate *c) {
    starg_status status = STARG_OK;
    starg_signature *other = NULL;
    bool row;
    sqlite3_bind_int64(statement, 2, c->id);
    STARG_TRY(database_step(d, statement, &row));
    STARG_TRY(database_read_signature(d, statement, 1, wanted->kind, &other));
    STARG_TRY(starg_signature_distance(d->context, wanted, other, &c->distance));
done:
    sqlite3_reset(statement);
    starg_signature_free(d->context, other);
    return status;
}

static starg_status refine(starg_database *d, const starg_signature *wanted,
                           const candidates *bounded, size_t capacity, candidates *nearest) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    TRY(database_prepare(
        d,
        "SELECT id, version, numbers FROM model LEFT JOIN signature ON model = id AND kind = ? "
        "WHERE id = ?",
        &statement));
    sqlite3_bind_text(statement, 1, starg_signature_name(wanted->kind), -1, SQLITE_STATIC);
    for (size_t i = 0; i < bounded->count; i++) {
        candidate c = bounded->data[i];
        TRY(starg_check_cancel(d->context, DATABASE_STAGE));
        if (nearest->count == capacity && c.distance > nearest->data[capacity - 1].distance)
            break;
        TRY(measure(d, statement, wanted, &c));
        consider(nearest, capacity, c);
    }
    return STARG_OK;
}

/* ---- public function ---- */

static starg_status count_models(starg_database *d, size_t *count) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    bool row;
    TRY(database_prepare(d, "SELECT count(*) FROM model", &statement));
    TRY(database_step(d, statement, &row));
    *count = row ? (size_t)sqlite3_column_int64(statement, 0) : 0;
    return STARG_OK;
}

/* Reads the models of the shortlist. */
static starg_status fetch(starg_database *d, const candidates *nearest, database_models *list) {
    SCOPED_BY(statement_drop) sqlite3_stmt *statement = NULL;
    TRY(database_prepare(d, "SELECT id, path, hash, vertices, faces FROM model WHERE id = ?",
                         &statement));
    for (size_t i = 0; i < nearest->count; i++) {
        size_t known = list->count;
        sqlite3_bind_int64(statement, 1, nearest->data[i].id);
        TRY(database_read_rows(d, statement, -1, list));
        if (list->count > known)
            list->data[known].distance = nearest->data[i].distance;
    }
    return STARG_OK;
}

starg_status starg_database_query(starg_database *d, const starg_signature *signature,
                                  size_t wanted, starg_database_models **out) {
    starg_status status = STARG_OK;
    candidates bounded = {0}, nearest = {0};
    database_models list = {0};
    size_t count = 0, capacity;
    *out = NULL;
    STARG_TRY(database_check_kind(d, signature->kind));
    /* one transaction, so that no other process changes anything in between */
    STARG_TRY(database_run(d, "BEGIN"));
    STARG_TRY(count_models(d, &count));
    capacity = wanted < count ? wanted : count;
    STARG_NEW(d->context, DATABASE_STAGE, nearest.data, capacity);
    if (capacity > 0) {
        STARG_TRY(bound_models(d, signature, count, &bounded));
        STARG_TRY(refine(d, signature, &bounded, capacity, &nearest));
    }
    STARG_TRY(fetch(d, &nearest, &list));
    STARG_TRY(database_models_hand_over(d->context, &list, out));
done:
    database_roll_back(d);
    RELEASE(bounded.data, nearest.data);
    database_models_clear(&list);
    return status;
}
