/* SPDX-License-Identifier: Apache-2.0 */
/* Better guards, without a bound: what `guard` does with its candidates unless told otherwise.
 *
 * A round does the first of these that finds something, by turns:
 *   1. points that are worth more than 1 by the prices, by moving known ones
 * (guard/search_moves.c);
 *   2. the linear program over all faces and the candidates: faces that it pays for become
 *      witnesses, and what covers everything with fewer guards is taken;
 *   3. the integer program over the points: better guards, or witnesses that these miss;
 *   4. faces that the fractional cover sees too little become witnesses;
 *   5. cells that may be worth more than 1 are split, each with two more points.
 * It ends when rounds have found nothing PATIENCE times, or with the budget. At last the most
 * valuable points become candidates, and an integer program over all faces chooses among these. */
#include <stdlib.h>

#include "guard/search_parts.h"

enum { TRIES = 2, PATIENCE = 4, MOST_HELD = 250 };

static const char STAGE[] = "search";

uint64_t search_improve_work(const search *s) {
    uint64_t asked = s->problem->options->refine_lines;
    return asked == STARG_DEFAULT_LINES ? 200000 + 60 * s->pool->columns + 60000 * s->count : asked;
}

starg_status search_improve(search *s, row_list *list) {
    starg_status status = STARG_OK;
    scored_leaf *leaves = NULL;
    size_t count;
    double most;
    bool changed = false;
    STARG_TRY(search_find_prices(s, list));
    if (s->moves % 4 < 2) {
        STARG_TRY(search_move(s, &most));
        if (most > 1 + SEARCH_GAP)
            goto done;
    }
    if (s->moves++ % 4 != 3) {
        STARG_TRY(search_ask_pool(s, list, &changed));
        if (changed)
            goto done;
    }
    if (search_has_room(s)) {
        size_t before = s->count;
        STARG_TRY(search_ask_points(s, &changed));
        if (s->count < before)
            s->idle = 0;
    }
    if (changed)
        goto done;
    STARG_TRY(search_add_short(s, list, &changed));
    if (changed)
        goto done;
    STARG_TRY(search_list_leaves(s, 1, &leaves, &count));
    if (count > 0)
        STARG_TRY(search_split(s, leaves, count, TRIES));
    s->ended = count == 0 || ++s->idle > PATIENCE;
done:
    starg_release(context_of(s), leaves);
    return status;
}

starg_status search_close(search *s) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    row_list list = {0};
    scored_leaf *scored = NULL;
    uint32_t *best = NULL;
    size_t count = 0;
    starg_cover *cover = NULL;
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = s->problem->options->max_nodes};
    STARG_TRY(row_list_make(context, 2 * s->points.count, &list));
    STARG_TRY(search_find_prices(s, &list));
    STARG_TRY(search_bound_points(s));
    if (s->known >= s->count)
        goto done;
    STARG_NEW(context, STAGE, scored, s->points.count);
    STARG_NEW(context, STAGE, best, s->points.count);
    for (size_t i = 0; i < s->points.count; i++) {
        double value = row_value(&s->points.data[i].seen, s->prices.price);
        if (s->points.data[i].candidate == UINT32_MAX && value > 0.9)
            scored[count++] = (scored_leaf){value, (uint32_t)i};
    }
    qsort(scored, count, sizeof *scored, search_by_score);
    if (count > MOST_HELD)
        count = MOST_HELD;
    for (size_t i = 0; i < count; i++)
        best[i] = scored[i].cell;
    STARG_TRY(search_hold(s, best, count));
    STARG_TRY(choose_candidates(s->pool, &s->problem->weights, &how, &cover));
    STARG_TRY(search_take_cover(s, cover));
    s->known = cover->lower_bound > s->known ? cover->lower_bound : s->known;
done:
    row_list_free(context, &list);
    starg_cover_free(cover);
    starg_release(context, scored);
    starg_release(context, best);
    return status;
}
