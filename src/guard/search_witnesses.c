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

starg_status search_count_views(search *s) {
    const starg_bits *rows = s->pool->rows;
    NEW_ZERO(context_of(s), STAGE, s->views, 64 * rows->words);
    NEW_ZERO(context_of(s), STAGE, s->viewers, 64 * rows->words);
    for (size_t i = 0; i < rows->rows; i++) {
        uint64_t number = starg_hash64(i + 1);
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w]) {
                s->views[64 * w + bit]++;
                s->viewers[64 * w + bit] += number;
            }
    }
    return STARG_OK;
}

static bool is_alike(const search *s, const scored_column *list, size_t count,
                     const scored_column *one) {
    for (size_t i = 0; i < count; i++)
        if (s->viewers[list[i].column] == s->viewers[one->column])
            return true;
    return false;
}

static bool is_witness(const search *s, uint32_t column) {
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        if (s->scene.witnesses.data[j] == column)
            return true;
    return false;
}

/* Marks the candidates that see a column; false: one of them was already marked. */
static bool mark_viewers(const search *s, uint32_t column, uint8_t *marked) {
    const starg_bits *rows = s->pool->rows;
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
static starg_status choose_columns(const search *s, scored_column *list, size_t count, size_t most,
                                   size_t *kept) {
    starg_status status = STARG_OK;
    uint8_t *marked = NULL;
    size_t rows = s->pool->rows->rows, before = SIZE_MAX, open = 0;
    STARG_NEW(context_of(s), STAGE, marked, rows);
    qsort(list, count, sizeof *list, by_score);
    for (size_t i = 0; i < count && open < MOST_CONSIDERED; i++)
        if (!is_alike(s, list, open, &list[i]) && !is_witness(s, list[i].column))
            list[open++] = list[i];
    *kept = 0;
    while (*kept < most && *kept != before) {
        before = *kept;
        memset(marked, 0, rows);
        for (size_t i = before; i < open && *kept < most; i++)
            if (mark_viewers(s, list[i].column, marked)) {
                scored_column chosen = list[i];
                memmove(&list[*kept + 1], &list[*kept], (i - *kept) * sizeof *list);
                list[(*kept)++] = chosen;
            }
    }
done:
    starg_release(context_of(s), marked);
    return status;
}

static starg_status look_at_new(search *s, size_t first) {
    for (size_t i = 0; i < s->points.count; i++) {
        search_point *point = &s->points.data[i];
        for (size_t j = first; point->candidate != UINT32_MAX && j < s->scene.witnesses.count; j++)
            if (starg_bits_test(s->pool->rows, point->candidate, s->scene.witnesses.data[j]))
                starg_bit_set(point->seen.bits, j);
    }
    TRY(points_look(&s->scene, &s->points, first));
    return cells_look(&s->scene, &s->cells, first);
}

/* Turns at most `most` columns with a score below `limit` into witnesses. *added: how many. */
static starg_status add_witnesses(search *s, const double *scores, double limit, size_t most,
                                  size_t *added) {
    starg_context *context = context_of(s);
    size_t columns = s->pool->columns, count = 0, first = s->scene.witnesses.count;
    SCOPED scored_column *list = NULL;
    *added = 0;
    NEW(context, STAGE, list, columns);
    for (size_t j = 0; j < columns; j++)
        if (s->need[j] == s->redundancy && scores[j] < limit)
            list[count++] = (scored_column){scores[j], s->views[j], (uint32_t)j};
    if (most > MOST_WITNESSES - first)
        most = MOST_WITNESSES - first;
    TRY(choose_columns(s, list, count, most, &count));
    for (size_t i = 0; i < count; i++)
        PUSH(context, STAGE, &s->scene.witnesses, list[i].column);
    *added = count;
    if (count > 0)
        TRY(look_at_new(s, first));
    return STARG_OK;
}

/* The rarest faces, then those that the fractional cover by candidates does not see enough. */
starg_status search_first_witnesses(search *s) {
    starg_status status = STARG_OK;
    double *scores = NULL;
    row_list list = {0};
    size_t added;
    bool changed = true;
    STARG_NEW(context_of(s), STAGE, scores, s->pool->columns);
    for (size_t j = 0; j < s->pool->columns; j++)
        scores[j] = s->views[j];
    STARG_TRY(add_witnesses(s, scores, INFINITY, FIRST_WITNESSES + s->count, &added));
    for (int k = 0; k < FIRST_ROUNDS && changed; k++) {
        row_list_free(context_of(s), &list);
        list = (row_list){0};
        STARG_TRY(row_list_make(context_of(s), 2 * s->points.count, &list));
        STARG_TRY(search_find_prices(s, &list));
        STARG_TRY(search_add_short(s, &list, &changed));
    }
done:
    row_list_free(context_of(s), &list);
    starg_release(context_of(s), scores);
    return status;
}

/* ---- all columns ---- */

starg_status search_hold(search *s, const uint32_t *points, size_t count) {
    starg_context *context = context_of(s);
    SCOPED_BY(candidates_free) candidate_points found = {0};
    TIME_RULE(context, STARG_TIME_IGNORED);
    uint32_t next = (uint32_t)pool_count(s->pool);
    for (size_t i = 0; i < count; i++) {
        search_point *point = &s->points.data[points[i]];
        if (point->candidate != UINT32_MAX)
            continue;
        bool looks = sensor_is_directed(s->scene.view);
        TRY(candidates_push_pose(context, &found, point->place, looks ? point->direction : NULL,
                                 point->up));
        point->candidate = next++;
    }
    s->scene.work += candidates_count(&found) * s->pool->columns / 20;
    if (found.data.count > 0)
        TRY(pool_add(s->pool, &found));
    return STARG_OK;
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
static bool see_most(const search *s, uint64_t *missing, uint32_t *candidate) {
    const starg_bits *rows = s->pool->rows;
    size_t most = 0;
    for (size_t i = 0; i < rows->rows; i++) {
        size_t seen = 0;
        for (size_t w = 0; w < rows->words; w++)
            seen += (size_t)__builtin_popcountll(starg_bits_row(rows, i)[w] & missing[w]);
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
    SCOPED STARG_ARRAY(uint32_t) guards = {0};
    SCOPED uint64_t *missing = NULL;
    size_t lacking = 0;
    NEW_ZERO(context_of(s), STAGE, missing, s->pool->rows->words);
    for (size_t i = 0; i < count; i++)
        PUSH(context_of(s), STAGE, &guards, s->points.data[points[i]].candidate);
    for (size_t j = 0; j < s->pool->columns; j++)
        if (seen[j] < s->need[j]) {
            starg_bit_set(missing, j);
            lacking++;
        }
    *complete = lacking == 0;
    uint32_t next = 0;
    while (lacking > 0 && s->redundancy == 1 && guards.count + 1 < s->count &&
           see_most(s, missing, &next)) {
        PUSH(context_of(s), STAGE, &guards, next);
        lacking = starg_bit_count(missing, s->pool->rows->words);
    }
    if (lacking > 0 || guards.count >= s->count)
        return STARG_OK;
    s->guards.count = 0;
    for (size_t i = 0; i < guards.count; i++)
        PUSH(context_of(s), STAGE, &s->guards, guards.data[i]);
    s->count = guards.count;
    s->better = true;
    return search_note_guards(s);
}

starg_status search_try_guards(search *s, const uint32_t *points, size_t count, bool *changed) {
    starg_status status = STARG_OK;
    double *seen = NULL;
    bool complete = false;
    size_t added = 0;
    STARG_TRY(search_hold(s, points, count));
    STARG_NEW_ZERO(context_of(s), STAGE, seen, 64 * s->pool->rows->words);
    for (size_t i = 0; i < count; i++)
        add_share(s, points[i], 1, seen);
    STARG_TRY(take_guards(s, points, count, seen, &complete));
    if (!complete)
        STARG_TRY(
            add_witnesses(s, seen, (double)s->redundancy, MORE_WITNESSES + s->count / 2, &added));
    *changed = complete || added > 0;
done:
    starg_release(context_of(s), seen);
    return status;
}

starg_status search_add_short(search *s, const row_list *list, bool *changed) {
    starg_context *context = context_of(s);
    SCOPED uint32_t *held = NULL;
    SCOPED double *sums = NULL;
    size_t added, count = 0;
    NEW(context, STAGE, held, list->count);
    for (size_t i = 0; i < list->count; i++)
        if (s->prices.share[i] >= LEAST_SHARE && list->points[i] != UINT32_MAX)
            held[count++] = list->points[i];
    TRY(search_hold(s, held, count));
    NEW_ZERO(context, STAGE, sums, 64 * s->pool->rows->words);
    for (size_t i = 0; i < list->count; i++)
        if (s->prices.share[i] >= LEAST_SHARE && list->points[i] != UINT32_MAX)
            add_share(s, list->points[i], s->prices.share[i], sums);
    TRY(add_witnesses(s, sums, ENOUGH, MORE_WITNESSES + s->count / 2, &added));
    *changed = added > 0;
    return STARG_OK;
}
