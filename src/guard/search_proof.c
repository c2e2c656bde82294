/* SPDX-License-Identifier: Apache-2.0 */
/* A bound for guards anywhere: what `guard --prove` does, and `guard` shortly at its end.
 *
 * A round improves both ends:
 *   1. find prices of the witnesses from the known points (guard/prices.c): no point exceeds 1;
 *   2. if the prices leave room for fewer guards, an integer program over the points looks for
 *      them. Its solution is tested against all faces: it gives better guards, or the faces that
 *      they miss become witnesses;
 *   3. split the cells whose total price may be too high for the target bound, starting with those
 *      of high price and large size, for as long as the prices took; add their points. Small cells
 *      are not split, but count as points in the prices (guard/search_prices.c);
 *   4. if there are no such cells, the prices prove the bound (guard/bound.c). If the bound is
 *      below the number of guards, odd sets of witnesses get prices (guard/odd_sets.c), and smaller
 *      cells are split as well; by turns faces that the fractional cover does not see enough become
 *      witnesses;
 *   5. if there are no such faces either, solve an integer program over cells and points: cells
 *      that would allow fewer guards are split, with more points; if no cells would, branching
 *      proves it, with separate prices in each branch.
 *
 * Invariant: a round ends with the bound that its prices prove for the current cells, so that more
 * work never proves less. Cost: guard/search.c counts it. */
#include <math.h>

#include "guard/prices.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { TRIES = 1 };

static const double ROUNDING = 1e-6;

/* ---- steps of a round ---- */

/* If the prices leave room for fewer guards, and enough is new since the last time: finds better
 * guards or more witnesses. */
static starg_status look_for_guards(search *s, bool last, bool *changed) {
    const search_asked *asked = &s->asked;
    const size_t cells = s->cells.count, witnesses = s->witnesses.scene.witnesses.count;
    bool grown = last ? cells > asked->cells + asked->cells / 10 || witnesses > asked->witnesses
                      : cells > asked->cells + asked->cells / 3 && s->effort.work >= asked->after;
    *changed = false;
    return grown && duals_leave_room(&s->duals, s->best.guards.count)
               ? search_ask_points(s, changed)
               : STARG_OK;
}

/* The next bound to prove: a third of the way to what the prices allow. Cells that block a lower
 * bound also block a higher one, so no work is lost; and if the budget ends before the highest
 * bound is proven, a lower one is. */
static size_t next_aim(const search_incumbent *best, double value) {
    double allowed = fmin((double)best->guards.count, ceil(value - ROUNDING));
    size_t most = allowed > 1 ? (size_t)allowed : 1;
    return best->bound < most ? best->bound + (most - best->bound + 2) / 3 : most;
}

static void drop_split(const search_cells *cells, leaf_list *list) {
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++)
        if (cells->data[list->data[i].cell].children == 0)
            list->data[kept++] = list->data[i];
    list->count = kept;
}

/* Splits leaves that block the next bound, until none does or as much work went into this as into
 * the prices. *changed: there are some; *ended: none of these can be split. */
static starg_status split_costly(search *s, bool *changed, bool *ended) {
    SCOPED leaf_list leaves = {0};
    uint64_t *work = &s->effort.work;
    const double value = duals_value(&s->duals);
    const size_t aim = next_aim(&s->best, value);
    const double most = aim > 1 ? value / (double)(aim - 1) * (1 - ROUNDING) : INFINITY;
    const uint64_t enough = *work + s->duals.prices.work;
    bool any = true;
    TRY(duals_list_leaves(&s->duals, most, 0, &leaves, work));
    *changed = leaves.count > 0;
    for (bool more = *changed; more; more = leaves.count > 0 && any && *work < enough) {
        size_t first = s->cells.count;
        TRY(cells_split_best(&s->witnesses.scene, &s->cells, &leaves, TRIES, &s->points, &any,
                             work));
        drop_split(&s->cells, &leaves);
        TRY(duals_list_leaves(&s->duals, most, first, &leaves, work));
    }
    *ended = !any;
    return STARG_OK;
}

/* No leaf blocks the bound of the prices: looks for better guards, more witnesses, or cells chosen
 * by an integer program. */
static starg_status ask_further(search *s, const row_list *list, bool *changed) {
    TRY(look_for_guards(s, true, changed));
    if (!*changed)
        TRY(search_add_short(s, list, changed));
    if (!*changed)
        TRY(search_ask_cells(s, changed));
    return STARG_OK;
}

/* No leaf that is not small blocks the bound of the prices. If small ones hold them down, half as
 * small ones do from now on; every third time, or if nothing else helps, looks further. */
static starg_status go_on(search *s, const row_list *list, bool *changed) {
    bool others, held = duals_are_held(&s->duals, list, &others);
    TRY(duals_find_odd(&s->duals, list, changed, &s->effort.work));
    if (!*changed && others)
        TRY(ask_further(s, list, changed));
    if (!*changed && held) {
        duals_set_finest(&s->duals, s->duals.finest / 2);
        *changed = true;
    }
    return STARG_OK;
}

/* ---- rounds ---- */

starg_status search_prove_by_prices(search *s) {
    SCOPED const witness_row **rows = NULL;
    whole_prices whole;
    size_t count = 0;
    NEW(s->problem->context, STAGE, rows, s->cells.count);
    for (size_t i = 0; i < s->cells.count; i++)
        if (s->cells.data[i].children == 0)
            rows[count++] = &s->cells.data[i].open;
    bound_round(&s->duals.prices, &s->duals.odd, &whole);
    size_t bound = bound_of_prices(rows, count, &whole, s->witnesses.redundancy);
    if (incumbent_raise(&s->best, bound))
        certificate_note_prices(s->problem->certificate, bound, &whole);
    return STARG_OK;
}

starg_status search_prove(search *s, row_list *list, bool *ended) {
    size_t before = s->best.bound;
    bool changed;
    *ended = false;
    TRY(duals_find(&s->duals, list, &s->effort.work));
    TRY(look_for_guards(s, false, &changed));
    if (!changed)
        TRY(split_costly(s, &changed, ended));
    TRY(search_prove_by_prices(s));
    if (changed || s->best.bound >= s->best.guards.count || s->best.bound > before)
        return STARG_OK;
    TRY(go_on(s, list, &changed));
    *ended = !changed;
    return search_prove_by_prices(s);
}

starg_status search_prove_by_leaves(search *s) {
    SCOPED_BY(row_list_free) row_list list = {0};
    if (s->best.bound == s->best.guards.count || starg_time_is_over(s->problem->context))
        return STARG_OK;
    duals_set_finest(&s->duals, INFINITY);
    TRY(row_list_make(&s->duals, &list));
    for (bool changed = true; changed;) {
        TRY(duals_find(&s->duals, &list, &s->effort.work));
        TRY(search_prove_by_prices(s));
        TRY(duals_find_odd(&s->duals, &list, &changed, &s->effort.work));
    }
    return STARG_OK;
}
