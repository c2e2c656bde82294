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

/* Shares of LEAST_WORK, and for each guard of what it adds. No proof closes from a guard too many,
 * so one that is asked for is worth the work. */
static const double QUICK[2] = {0.05, 0.05}, NORMAL[2] = {0.25, 0.45}, PROVEN[2] = {1, 1},
                    BEST[2] = {1.5, 1.5};

/* Programs grow with the guards, and their rows with the faces. */
static double work_of(const search *s, const double share[2]) {
    double rows = 10 * (double)s->pool->columns, guards = (double)s->best.guards.count;
    return share[0] * LEAST_WORK + share[1] * guards * fmax(rows, WORK_PER_GUARD);
}

uint64_t search_improve_work(const search *s) {
    const starg_guard_options *o = s->problem->options;
    uint64_t asked = o->refine_lines != STARG_DEFAULT_LINES ? o->refine_lines : o->effort;
    if (asked <= INT64_MAX)
        return (uint64_t)((double)asked / search_scene_unit(&s->witnesses.scene));
    return (uint64_t)work_of(s, asked == STARG_EFFORT_QUICK                ? QUICK
                                : asked == STARG_EFFORT_NORMAL && o->prove ? PROVEN
                                : asked == STARG_EFFORT_NORMAL             ? NORMAL
                                                                           : BEST);
}

/* Points worth more than 1, unless the round before found some: then it is the turn of guards. */
static starg_status move_points(search *s, bool *changed) {
    double most = 0;
    if (!s->improving.moved)
        TRY(search_move(&s->witnesses.scene, &s->duals.prices, s->improving.draws++, &s->points,
                        &s->effort, &most));
    *changed = s->improving.moved = most > 1 + SEARCH_GAP;
    return STARG_OK;
}

/* *ended: this has failed too often. */
static starg_status look_for_fewer(search *s, bool *changed, bool *ended) {
    const size_t before = s->best.guards.count;
    TRY(search_fewer(s, s->improving.draws++, changed));
    const size_t guards = s->best.guards.count;
    const int failures = duals_leave_room(&s->duals, guards) ? 1 : HOPELESS;
    s->improving.idle = guards < before ? 0 : s->improving.idle + failures;
    *ended = s->improving.idle > PATIENCE;
    return STARG_OK;
}

/* *ended: there is none to split. */
static starg_status split_cells(search *s, bool *ended) {
    SCOPED leaf_list leaves = {0};
    bool any;
    TRY(duals_list_leaves(&s->duals, 1, 0, &leaves, &s->effort.work));
    *ended = leaves.count == 0;
    return *ended ? STARG_OK
                  : cells_split_best(&s->witnesses.scene, &s->cells, &leaves, TRIES, &s->points,
                                     &any, &s->effort.work);
}

starg_status search_improve(search *s, row_list *list, bool *ended) {
    bool changed;
    TRY(duals_find(&s->duals, list, &s->effort.work));
    TRY(move_points(s, &changed));
    if (!changed)
        TRY(look_for_fewer(s, &changed, ended));
    if (!changed && !*ended)
        TRY(search_add_short(s, list, &changed));
    if (!changed && !*ended)
        TRY(split_cells(s, ended));
    return STARG_OK;
}

/* ---- integer programs ---- */

/* Looks for fewer guards among the known points. *open: there may be some. Skips the program if
 * there are many witnesses: one over all faces tells more and is as fast. */
static starg_status ask_again(search *s, bool *open) {
    SCOPED_BY(row_list_free) row_list list = {0};
    const bool few = s->witnesses.scene.witnesses.count <= MOST_ASKED_OF;
    *open = true;
    TRY(row_list_make(&s->duals, &list));
    for (int k = 0; k < (few ? ASKED : 1) && *open; k++) {
        TRY(duals_find(&s->duals, &list, &s->effort.work));
        TRY(points_prove(&s->duals, &s->points));
        *open = s->points.bound < s->best.guards.count;
        if (*open && few)
            TRY(search_ask_points(s, open));
    }
    return STARG_OK;
}

/* The most valuable points become candidates. */
static starg_status hold_best(search *s) {
    starg_context *context = s->problem->context;
    SCOPED scored_leaf *scored = NULL;
    SCOPED uint32_t *best = NULL;
    size_t count = 0;
    NEW(context, STAGE, scored, s->points.count);
    NEW(context, STAGE, best, s->points.count);
    for (size_t i = 0; i < s->points.count; i++) {
        double value = row_value(&s->points.data[i].seen, s->duals.prices.price);
        if (s->points.data[i].candidate == UINT32_MAX && value > 0.9)
            scored[count++] = (scored_leaf){value, (uint32_t)i};
    }
    qsort(scored, count, sizeof *scored, cells_by_score);
    size_t most = guard_is_brief(s->problem->options) ? SHORT_HELD : MOST_HELD;
    if (count > most)
        count = most;
    for (size_t i = 0; i < count; i++)
        best[i] = scored[i].cell;
    return points_hold(&s->witnesses.scene, best, count, &s->points, s->pool, &s->effort.work);
}

static starg_status ask_all(search *s) {
    bool open = false;
    TRY(ask_again(s, &open));
    if (!open || starg_time_is_over(s->problem->context))
        return STARG_OK;
    TRY(hold_best(s));
    return search_ask_candidates(s);
}

/* If the bound is met, what is known of the points is renewed all the same. */
starg_status search_close(search *s, bool *better) {
    size_t before = s->best.guards.count;
    if (s->best.bound < before)
        TRY(ask_all(s));
    else
        TRY(points_prove(&s->duals, &s->points));
    *better = s->best.guards.count < before;
    if (*better)
        s->improving.idle = 0;
    return STARG_OK;
}
