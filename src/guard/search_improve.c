/* SPDX-License-Identifier: Apache-2.0 */
/* Better guards, without a bound: what `guard` does with its candidates by default.
 *
 * A round finds prices, and then takes the first of these steps that succeeds, in rotation:
 *   1. points worth more than 1, by moving known ones (guard/search_moves.c);
 *   2. local search for one guard fewer among known and new points (guard/search_fewer.c): better
 *      guards, or witnesses that these miss;
 *   3. faces that the fractional cover sees too little become witnesses;
 *   4. cells that may be worth more than 1 are split, with two new points in each part.
 * The rounds end when local search has failed PATIENCE times, or a third as often if the prices
 * leave no room for better guards, or with their share of the budget. Then integer programs over
 * the points give a bound for them and what local search has missed: over the witnesses if these
 * are few; if that does not finish, over all faces and the candidates that may be among fewer
 * guards, extended by the most valuable points. guard/search.c repeats both: with many guards,
 * these programs find more in the points of a few rounds than many rounds do. */
#include <math.h>
#include <stdlib.h>

#include "guard/search_parts.h"

enum {
    LEAST_WORK = 4000000,
    WORK_PER_GUARD = 200000,
    TRIES = 2,
    PATIENCE = 9,
    HOPELESS = 3,
    MOST_HELD = 250,
    SHORT_HELD = 60, /* where there are more closings, and each is short */
    ASKED = 4,
    MOST_ASKED_OF = 300
};

static const char STAGE[] = "search";

/* Shares of the work of the best effort: of what any model gets, and of what each guard adds. */
static const double QUICK[2] = {0.05, 0.05}, NORMAL[2] = {0.25, 0.45}, BEST[2] = {1, 1};

/* Programs grow with the guards, and their rows with the faces. */
static double work_of(const search *s, const double share[2]) {
    double rows = 10 * (double)s->pool->columns;
    return share[0] * LEAST_WORK + share[1] * (double)s->count * fmax(rows, WORK_PER_GUARD);
}

uint64_t search_improve_work(const search *s) {
    const starg_guard_options *o = s->problem->options;
    uint64_t asked = o->refine_lines != STARG_DEFAULT_LINES ? o->refine_lines : o->effort;
    if (asked <= INT64_MAX)
        return (uint64_t)((double)asked / search_scene_unit(&s->scene));
    return (uint64_t)work_of(s, asked == STARG_EFFORT_QUICK    ? QUICK
                                : asked == STARG_EFFORT_NORMAL ? NORMAL
                                                               : BEST);
}

starg_status search_improve(search *s, row_list *list) {
    starg_status status = STARG_OK;
    leaf_list leaves = {0};
    size_t before = s->count;
    double most;
    bool changed = false;
    STARG_TRY(search_find_prices(s, list));
    if (s->moves % 2 == 0) {
        STARG_TRY(search_move(s, &most));
        if (most > 1 + SEARCH_GAP)
            goto done;
    }
    STARG_TRY(search_fewer(s, &changed));
    s->idle = s->count < before ? 0 : s->idle + (search_has_room(s) ? 1 : HOPELESS);
    if (s->idle > PATIENCE) {
        s->ended = true;
        goto done;
    }
    if (!changed)
        STARG_TRY(search_add_short(s, list, &changed));
    if (changed)
        goto done;
    STARG_TRY(search_list_leaves(s, 1, 0, &leaves));
    if (leaves.count > 0)
        STARG_TRY(search_split(s, leaves.data, leaves.count, TRIES));
    s->ended = leaves.count == 0;
done:
    STARG_ARRAY_FREE(context_of(s), &leaves);
    return status;
}

/* Looks for fewer guards among the known points. *open: there may be some. Skips the program if
 * there are many witnesses: one over all faces tells more and is as fast. */
static starg_status ask_again(search *s, bool *open) {
    starg_status status = STARG_OK;
    row_list list = {0};
    *open = true;
    STARG_TRY(row_list_make(context_of(s), 2 * s->points.count, &list));
    bool few = s->scene.witnesses.count <= MOST_ASKED_OF;
    for (int k = 0; k < (few ? ASKED : 1) && *open; k++) {
        STARG_TRY(search_find_prices(s, &list));
        STARG_TRY(search_bound_points(s));
        *open = s->known < s->count;
        if (*open && few)
            STARG_TRY(search_ask_points(s, open));
    }
done:
    row_list_free(context_of(s), &list);
    return status;
}

/* The most valuable points become candidates. */
static starg_status hold_best(search *s) {
    starg_context *context = context_of(s);
    SCOPED scored_leaf *scored = NULL;
    SCOPED uint32_t *best = NULL;
    size_t count = 0;
    NEW(context, STAGE, scored, s->points.count);
    NEW(context, STAGE, best, s->points.count);
    for (size_t i = 0; i < s->points.count; i++) {
        double value = row_value(&s->points.data[i].seen, s->prices.price);
        if (s->points.data[i].candidate == UINT32_MAX && value > 0.9)
            scored[count++] = (scored_leaf){value, (uint32_t)i};
    }
    qsort(scored, count, sizeof *scored, search_by_score);
    size_t most = guard_is_brief(s->problem->options) ? SHORT_HELD : MOST_HELD;
    if (count > most)
        count = most;
    for (size_t i = 0; i < count; i++)
        best[i] = scored[i].cell;
    return search_hold(s, best, count);
}

starg_status search_close(search *s) {
    bool open = false;
    TRY(ask_again(s, &open));
    if (!open || starg_time_is_over(context_of(s)))
        return STARG_OK;
    TRY(hold_best(s));
    if (pool_count(s->pool) > s->asked_pool)
        TRY(search_ask_candidates(s));
    s->known = s->asked_bound > s->known ? s->asked_bound : s->known;
    return STARG_OK;
}
