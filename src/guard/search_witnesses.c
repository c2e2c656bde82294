/* SPDX-License-Identifier: Apache-2.0 */
/* Witnesses of a search: the faces that represent all of them.
 *
 * The first are faces that the fewest candidates see, and those that a fractional cover by
 * candidates sees too little. Later ones are faces that some guards miss (or do not see often
 * enough) although they see all witnesses, or that a fractional cover by all points sees too
 * little. One face represents all those that the same candidates see. All points and cells are
 * tested against new witnesses.
 *
 * Invariant: the initial guards see every witness as often as required. */
#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { FIRST_WITNESSES = 30, FIRST_ROUNDS = 8, MORE_WITNESSES = 10, MOST_CONSIDERED = 2000 };

/* Of a fractional cover: the smallest share considered, and what suffices for a column. */
static const double LEAST_SHARE = 0.003, ENOUGH = 0.95;

/* ---- witnesses ---- */

typedef struct scored_column {
    double score;
    uint32_t views, column;
} scored_column;

static int by_score(const void *a, const void *b) {
    const scored_column *x = a, *y = b;
    if (x->score != y->score)
        return x->score < y->score ? -1 : 1;
    if (x->views != y->views)
        return x->views < y->views ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

starg_status witness_set_begin(const guard_problem *problem, const guard_pool *pool,
                               const guard_selection *selection, witness_set *out) {
    const starg_bits *rows = pool->rows;
    const starg_guard_options *o = problem->options;
    out->redundancy = o->redundancy;
    TRY(search_scene_open(problem->context, problem->solid, &o->visibility, o->clearance,
                          &out->scene));
    NEW_ZERO(pool->context, STAGE, out->need, 64 * rows->words);
    for (size_t i = 0; i < selection->chosen.count; i++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, selection->chosen.data[i])[w])
                out->need[64 * w + bit] += out->need[64 * w + bit] < out->redundancy;
    TRY(pool_supply(pool, &out->views));
    NEW_ZERO(problem->context, STAGE, out->viewers, 64 * rows->words);
    for (size_t i = 0; i < rows->rows; i++) {
        uint64_t number = starg_hash64(i + 1);
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w])
                out->viewers[64 * w + bit] += number;
    }
    return STARG_OK;
}

void witness_set_end(witness_set *set) {
    RELEASE(set->need, set->views, set->viewers);
    search_scene_close(&set->scene);
}

static bool is_alike(const witness_set *set, const scored_column *list, size_t count,
                     const scored_column *one) {
    for (size_t i = 0; i < count; i++)
        if (set->viewers[list[i].column] == set->viewers[one->column])
            return true;
    return false;
}

static bool is_witness(const search_scene *scene, uint32_t column) {
    for (size_t j = 0; j < scene->witnesses.count; j++)
        if (scene->witnesses.data[j] == column)
            return true;
    return false;
}

/* Marks the candidates that see a column; false: one of them was already marked. */
static bool mark_viewers(const starg_bits *rows, uint32_t column, uint8_t *marked) {
    for (size_t i = 0; i < rows->rows; i++)
        if (marked[i] && starg_bits_test(rows, i, column))
            return false;
    for (size_t i = 0; i < rows->rows; i++)
        if (starg_bits_test(rows, i, column))
            marked[i] = 1;
    return true;
}

/* Moves at most `most` columns to the front, by increasing score, no two of which the same
 * candidates see. Within a pass no candidate sees two of the chosen columns, so they spread over
 * the whole solid, and each needs its own guard. */
static starg_status choose_columns(const witness_set *set, const starg_bits *rows,
                                   scored_column *list, size_t count, size_t most, size_t *kept) {
    SCOPED uint8_t *marked = NULL;
    size_t before = SIZE_MAX, open = 0;
    NEW(set->scene.context, STAGE, marked, rows->rows);
    qsort(list, count, sizeof *list, by_score);
    for (size_t i = 0; i < count && open < MOST_CONSIDERED; i++)
        if (!is_alike(set, list, open, &list[i]) && !is_witness(&set->scene, list[i].column))
            list[open++] = list[i];
    *kept = 0;
    while (*kept < most && *kept != before) {
        before = *kept;
        memset(marked, 0, rows->rows);
        for (size_t i = before; i < open && *kept < most; i++)
            if (mark_viewers(rows, list[i].column, marked)) {
                scored_column chosen = list[i];
                memmove(&list[*kept + 1], &list[*kept], (i - *kept) * sizeof *list);
                list[(*kept)++] = chosen;
            }
    }
    return STARG_OK;
}

/* Turns at most `most` columns with a score below `limit` into witnesses, and tests points and
 * cells against them. *any: there are some. */
static starg_status add_witnesses(search *s, const double *scores, double limit, size_t most,
                                  bool *any) {
    witness_set *set = &s->witnesses;
    size_t columns = s->pool->columns, count = 0, first = set->scene.witnesses.count;
    SCOPED scored_column *list = NULL;
    *any = false;
    NEW(set->scene.context, STAGE, list, columns);
    for (size_t j = 0; j < columns; j++)
        if (set->need[j] == set->redundancy && scores[j] < limit)
            list[count++] = (scored_column){scores[j], set->views[j], (uint32_t)j};
    if (most > MOST_WITNESSES - first)
        most = MOST_WITNESSES - first;
    TRY(choose_columns(set, s->pool->rows, list, count, most, &count));
    for (size_t i = 0; i < count; i++)
        PUSH(set->scene.context, STAGE, &set->scene.witnesses, list[i].column);
    *any = count > 0;
    if (count == 0)
        return STARG_OK;
    TRY(points_look(&set->scene, s->pool, first, &s->points, &s->effort.work));
    return cells_look(&set->scene, &s->cells, first, &s->effort.work);
}

/* The rarest faces, then those that the fractional cover by candidates does not see enough. */
starg_status search_first_witnesses(search *s) {
    starg_context *context = s->problem->context;
    SCOPED_BY(row_list_free) row_list list = {0};
    SCOPED double *scores = NULL;
    bool changed = true;
    NEW(context, STAGE, scores, s->pool->columns);
    for (size_t j = 0; j < s->pool->columns; j++)
        scores[j] = s->witnesses.views[j];
    TRY(add_witnesses(s, scores, INFINITY, FIRST_WITNESSES + s->best.guards.count, &changed));
    TRY(row_list_make(&s->duals, &list));
    changed = true;
    for (int k = 0; k < FIRST_ROUNDS && changed; k++) {
        TRY(duals_find(&s->duals, &list, &s->effort.work));
        TRY(search_add_short(s, &list, &changed));
    }
    return STARG_OK;
}

/* ---- all columns ---- */

static starg_status hold(search *s, const uint32_t *points, size_t count) {
    return points_hold(&s->witnesses.scene, points, count, &s->points, s->pool, &s->effort.work);
}

/* Adds a share for each column that the point sees. */
static void add_share(const search *s, uint32_t point, double share, double *sums) {
    const starg_bits *rows = s->pool->rows;
    const uint64_t *row = starg_bits_row(rows, s->points.data[point].candidate);
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, row[w])
            sums[64 * w + bit] += share;
}

/* Removes from `missing` what the candidate that sees most of it sees; false: none sees any. */
static bool see_most(const starg_bits *rows, uint64_t *missing, uint32_t *candidate) {
    size_t most = 0;
    for (size_t i = 0; i < rows->rows; i++) {
        size_t seen = 0;
        for (size_t w = 0; w < rows->words; w++)
            seen += starg_bits_in(starg_bits_row(rows, i)[w] & missing[w]);
        if (seen > most) {
            most = seen;
            *candidate = (uint32_t)i;
        }
    }
    for (size_t w = 0; w < rows->words && most > 0; w++)
        missing[w] &= ~starg_bits_row(rows, *candidate)[w];
    return most > 0;
}

/* Takes the points as guards, with candidates for what they miss, if that is an improvement.
 * `seen`: by column, how many of the points see it. */
static starg_status take_guards(search *s, const uint32_t *points, size_t count, const double *seen,
                                bool *complete) {
    starg_context *context = s->problem->context;
    const witness_set *set = &s->witnesses;
    SCOPED STARG_ARRAY(uint32_t) guards = {0};
    SCOPED uint64_t *missing = NULL;
    size_t lacking = 0, before = s->best.guards.count;
    NEW_ZERO(context, STAGE, missing, s->pool->rows->words);
    for (size_t i = 0; i < count; i++)
        PUSH(context, STAGE, &guards, s->points.data[points[i]].candidate);
    for (size_t j = 0; j < s->pool->columns; j++)
        if (seen[j] < set->need[j]) {
            starg_bit_set(missing, j);
            lacking++;
        }
    *complete = lacking == 0;
    uint32_t next = 0;
    while (lacking > 0 && set->redundancy == 1 && guards.count + 1 < before &&
           see_most(s->pool->rows, missing, &next)) {
        PUSH(context, STAGE, &guards, next);
        lacking = starg_bit_count(missing, s->pool->rows->words);
    }
    if (lacking > 0 || guards.count >= before)
        return STARG_OK;
    return incumbent_take(context, guards.data, guards.count, s->effort.work, &s->best);
}

/* So many columns become witnesses at a time. */
static size_t batch_of(const search *s) {
    return MORE_WITNESSES + s->best.guards.count / 2;
}

starg_status search_try_guards(search *s, const uint32_t *points, size_t count, bool *changed) {
    SCOPED double *seen = NULL;
    TRY(hold(s, points, count));
    NEW_ZERO(s->problem->context, STAGE, seen, 64 * s->pool->rows->words);
    for (size_t i = 0; i < count; i++)
        add_share(s, points[i], 1, seen);
    TRY(take_guards(s, points, count, seen, changed));
    return *changed ? STARG_OK
                    : add_witnesses(s, seen, (double)s->witnesses.redundancy, batch_of(s), changed);
}

starg_status search_add_short(search *s, const row_list *list, bool *changed) {
    starg_context *context = s->problem->context;
    const double *share = s->duals.prices.share;
    SCOPED uint32_t *held = NULL;
    SCOPED double *sums = NULL;
    size_t count = 0;
    NEW(context, STAGE, held, list->count);
    for (size_t i = 0; i < list->count; i++)
        if (share[i] >= LEAST_SHARE && list->names[i] < ROW_LEAF)
            held[count++] = list->names[i];
    TRY(hold(s, held, count));
    NEW_ZERO(context, STAGE, sums, 64 * s->pool->rows->words);
    for (size_t i = 0; i < list->count; i++)
        if (share[i] >= LEAST_SHARE && list->names[i] < ROW_LEAF)
            add_share(s, list->names[i], share[i], sums);
    return add_witnesses(s, sums, ENOUGH, batch_of(s), changed);
}
