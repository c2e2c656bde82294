/* SPDX-License-Identifier: Apache-2.0 */
/* Witnesses of a search: which faces stand for all of them.
 *
 * Those that pay most in the candidates' program are the first. Later ones are faces that guards
 * which see all witnesses do not see, those first that the fewest candidates see, or that a
 * fractional cover sees too little. Of faces that the same candidates see one is enough. All points
 * and cells look at what is new.
 *
 * Invariant: all witnesses are among the faces that the guards at the beginning saw. */
#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { FIRST_WITNESSES = 150, MORE_WITNESSES = 20 };

/* ---- witnesses ---- */

typedef struct scored_column {
    double score;
    uint64_t viewers; /* a number for the set of candidates that see it */
    uint32_t column;
} scored_column;

static int by_score(const void *a, const void *b) {
    const scored_column *x = a, *y = b;
    if (x->score != y->score)
        return x->score < y->score ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* The sum of a random number for each candidate that sees the column. */
static void number_viewers(const search *s, uint64_t *viewers) {
    const starg_bits *rows = s->pool->rows;
    for (size_t i = 0; i < rows->rows; i++) {
        uint64_t number = starg_hash64(i + 1);
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w])
                viewers[64 * w + bit] += number;
    }
}

static bool is_alike(const scored_column *list, size_t count, const scored_column *one) {
    for (size_t i = 0; i < count; i++)
        if (list[i].viewers == one->viewers)
            return true;
    return false;
}

static bool is_witness(const search *s, uint32_t column) {
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        if (s->scene.witnesses.data[j] == column)
            return true;
    return false;
}

/* Moves at most `most` columns to the front: the least scores first, no two of which the same
 * candidates see. */
static size_t choose_columns(const search *s, scored_column *list, size_t count, size_t most) {
    size_t kept = 0;
    qsort(list, count, sizeof *list, by_score);
    for (size_t i = 0; i < count && kept < most; i++)
        if (!is_alike(list, kept, &list[i]) && !is_witness(s, list[i].column))
            list[kept++] = list[i];
    return kept;
}

static starg_status look_at_new(search *s, size_t first) {
    starg_status status = STARG_OK;
    for (size_t i = 0; i < s->points.count; i++) {
        search_point *point = &s->points.data[i];
        for (size_t j = first; point->candidate != UINT32_MAX && j < s->scene.witnesses.count; j++)
            if (starg_bits_test(s->pool->rows, point->candidate, s->scene.witnesses.data[j]))
                starg_bit_set(point->seen.bits, j);
    }
    STARG_TRY(points_look(&s->scene, &s->points, first));
    STARG_TRY(cells_look(&s->scene, &s->cells, first));
done:
    return status;
}

/* Columns below `limit` of a score become witnesses, as many as `most`. *added: how many. */
static starg_status add_witnesses(search *s, const double *scores, double limit, size_t most,
                                  size_t *added) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    size_t columns = s->pool->columns, count = 0, first = s->scene.witnesses.count;
    scored_column *list = NULL;
    uint64_t *viewers = NULL;
    *added = 0;
    STARG_NEW(context, STAGE, list, columns);
    STARG_NEW_ZERO(context, STAGE, viewers, 64 * starg_bit_words(columns));
    number_viewers(s, viewers);
    for (size_t j = 0; j < columns; j++)
        if (starg_bit_test(s->wanted, j) && scores[j] < limit)
            list[count++] = (scored_column){scores[j], viewers[j], (uint32_t)j};
    if (most > MOST_WITNESSES - first)
        most = MOST_WITNESSES - first;
    count = choose_columns(s, list, count, most);
    for (size_t i = 0; i < count; i++)
        STARG_PUSH(context, STAGE, &s->scene.witnesses, list[i].column);
    *added = count;
    if (count > 0)
        STARG_TRY(look_at_new(s, first));
done:
    starg_release(context, list);
    starg_release(context, viewers);
    return status;
}

/* The faces that carry most of the price of the candidates' program. */
starg_status search_first_witnesses(search *s) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    starg_cover *cover = NULL;
    double *scores = NULL;
    size_t added;
    const choice how = {.method = STARG_COVER_LP, .prices = true};
    STARG_TRY(choose_candidates(s->pool, &s->problem->weights, &how, &cover));
    STARG_NEW(context, STAGE, scores, s->pool->columns);
    for (size_t j = 0; j < s->pool->columns; j++)
        scores[j] = -cover->prices[j];
    STARG_TRY(add_witnesses(s, scores, -1e-6, FIRST_WITNESSES, &added));
done:
    starg_cover_free(cover);
    starg_release(context, scores);
    return status;
}

/* ---- guards ---- */

static starg_status see_all(const search *s, const double *places, size_t count, starg_bits **out) {
    starg_visibility_options view = s->problem->options->visibility;
    starg_time_rule former = starg_time_begin(context_of(s), STARG_TIME_IGNORED);
    view.engine = STARG_VISIBILITY_FASTEST;
    starg_status status =
        starg_visibility(context_of(s), s->problem->solid, places, count, &view, out);
    starg_time_end(context_of(s), former);
    return status;
}

/* How many candidates see each column that is wanted and that no row holds; INFINITY for others. */
static starg_status score_missing(const search *s, const starg_bits *rows, double *scores,
                                  bool *any) {
    starg_status status = STARG_OK;
    uint64_t *joined = NULL;
    STARG_TRY(pool_join_rows(context_of(s), rows, &joined));
    *any = false;
    for (size_t j = 0; j < s->pool->columns; j++) {
        bool missing = starg_bit_test(s->wanted, j) && !starg_bit_test(joined, j);
        scores[j] = missing ? 0 : INFINITY;
        *any = *any || missing;
    }
    for (size_t i = 0; *any && i < s->pool->rows->rows; i++)
        for (size_t w = 0; w < s->pool->rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(s->pool->rows, i)[w] & ~joined[w])
                scores[64 * w + bit] += 1;
done:
    starg_release(context_of(s), joined);
    return status;
}

static starg_status take_guards(search *s, const double *places, size_t count) {
    starg_status status = STARG_OK;
    s->guards.count = 0;
    for (size_t k = 0; k < 3 * count; k++)
        STARG_PUSH(context_of(s), STAGE, &s->guards, places[k]);
    s->count = count;
    s->better = true;
done:
    return status;
}

/* Points that see all witnesses: better guards, or witnesses to come. */
starg_status search_try_guards(search *s, const double *places, size_t count, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    starg_bits *rows = NULL;
    double *scores = NULL;
    bool missing;
    size_t added = 0;
    STARG_TRY(see_all(s, places, count, &rows));
    s->scene.work += count * s->pool->columns / 4;
    STARG_NEW(context, STAGE, scores, 64 * rows->words);
    STARG_TRY(score_missing(s, rows, scores, &missing));
    if (!missing)
        STARG_TRY(take_guards(s, places, count));
    else
        STARG_TRY(add_witnesses(s, scores, INFINITY, MORE_WITNESSES, &added));
    *changed = !missing || added > 0;
done:
    starg_bits_free(rows);
    starg_release(context, scores);
    return status;
}

/* Columns that the fractional cover does not see often enough become witnesses. */
starg_status search_add_short(search *s, const row_list *list, bool *changed) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    STARG_ARRAY(double) places = {0}, shares = {0};
    starg_bits *rows = NULL;
    double *scores = NULL;
    size_t added;
    for (size_t i = 0; i < list->count; i++) {
        if (s->prices.share[i] < 0.003)
            continue;
        for (int k = 0; k < 3; k++)
            STARG_PUSH(context, STAGE, &places, s->points.data[list->points[i]].place[k]);
        STARG_PUSH(context, STAGE, &shares, s->prices.share[i]);
    }
    STARG_TRY(see_all(s, places.data, shares.count, &rows));
    s->scene.work += shares.count * s->pool->columns / 4;
    STARG_NEW_ZERO(context, STAGE, scores, 64 * rows->words);
    for (size_t i = 0; i < shares.count; i++)
        for (size_t w = 0; w < rows->words; w++)
            STARG_FOR_BITS (bit, starg_bits_row(rows, i)[w])
                scores[64 * w + bit] += shares.data[i];
    STARG_TRY(add_witnesses(s, scores, 0.95, MORE_WITNESSES, &added));
    *changed = added > 0;
done:
    STARG_ARRAY_FREE(context, &places);
    STARG_ARRAY_FREE(context, &shares);
    starg_bits_free(rows);
    starg_release(context, scores);
    return status;
}
