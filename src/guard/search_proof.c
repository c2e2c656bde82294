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
 *      below the number of guards, odd sets of witnesses get prices (guard/odd_sets.h), and smaller
 *      cells are split as well; by turns faces that the fractional cover does not see enough become
 *      witnesses;
 *   5. if there are no such faces either, solve an integer program over cells and points: cells
 *      that would allow fewer guards are split, with more points; if no cells would, branching
 *      proves it, with separate prices in each branch.
 *
 * Invariant: a round ends with the bound that its prices prove for the current cells, so that more
 * work never proves less. Cost: guard/search.c counts it. */
#include <math.h>

#include "guard/certificate.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

enum { TRIES = 1 };

static const double ROUNDING = 1e-6;

starg_status search_prove(search *s) {
    starg_status status = STARG_OK;
    const witness_row **rows = NULL;
    whole_prices whole;
    size_t count = 0;
    STARG_NEW(context_of(s), STAGE, rows, s->cells.count);
    for (size_t i = 0; i < s->cells.count; i++)
        if (s->cells.data[i].children == 0)
            rows[count++] = &s->cells.data[i].open;
    bound_round(&s->prices, &s->odd, &whole);
    size_t bound = bound_of_prices(rows, count, &whole, s->redundancy);
    if (bound > s->bound)
        certificate_note_prices(s->problem->certificate, bound, &whole);
    s->bound = bound > s->bound ? bound : s->bound;
done:
    starg_release(context_of(s), rows);
    return status;
}

bool search_has_room(const search *s) {
    return search_value(s) <= (double)s->count - 1 + SEARCH_GAP;
}

static void drop_split(const search *s, leaf_list *list) {
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++)
        if (s->cells.data[list->data[i].cell].children == 0)
            list->data[kept++] = list->data[i];
    list->count = kept;
}

/* If the prices leave room for fewer guards: finds better guards or more witnesses. */
static starg_status look_for_guards(search *s, bool last, bool *changed) {
    *changed = false;
    bool grown =
        last ? s->cells.count > s->asked_at + s->asked_at / 10 ||
                   s->scene.witnesses.count > s->asked_of
             : s->cells.count > s->asked_at + s->asked_at / 3 && s->scene.work >= s->ask_after;
    if (!search_has_room(s) || !grown)
        return STARG_OK;
    return search_ask_points(s, changed);
}

/* The next bound to prove: a third of the way to what the prices allow. Cells that block a lower
 * bound also block a higher one, so no work is lost; and if the budget ends before the highest
 * bound is proven, a lower one is. */
static size_t next_aim(const search *s) {
    double allowed = fmin((double)s->count, ceil(search_value(s) - ROUNDING));
    size_t most = allowed > 1 ? (size_t)allowed : 1;
    return s->bound < most ? s->bound + (most - s->bound + 2) / 3 : most;
}

/* Splits leaves that block the next bound, until none does or as much work went into this as into
 * the prices. *changed: there are some. */
static starg_status split_costly(search *s, bool *changed) {
    starg_status status = STARG_OK;
    leaf_list leaves = {0};
    size_t aim = next_aim(s);
    double most = aim > 1 ? search_value(s) / (double)(aim - 1) * (1 - ROUNDING) : INFINITY;
    uint64_t enough = s->scene.work + s->prices.work;
    STARG_TRY(search_list_leaves(s, most, 0, &leaves));
    *changed = leaves.count > 0;
    for (bool more = *changed; more;
         more = leaves.count > 0 && !s->ended && s->scene.work < enough) {
        size_t first = s->cells.count;
        STARG_TRY(search_split(s, leaves.data, leaves.count, TRIES));
        drop_split(s, &leaves);
        STARG_TRY(search_list_leaves(s, most, first, &leaves));
    }
done:
    STARG_ARRAY_FREE(context_of(s), &leaves);
    return status;
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
    bool bind = search_fine_bind(s, list), turn = bind && ++s->refinements % 3 != 0;
    TRY(search_find_odd(s, list, changed));
    if (!*changed && !turn)
        TRY(ask_further(s, list, changed));
    if (!*changed && bind) {
        s->finest /= 2;
        *changed = true;
    }
    s->ended = !*changed;
    return STARG_OK;
}

starg_status search_prove_round(search *s, row_list *list) {
    size_t before = s->bound;
    bool changed;
    TRY(search_find_prices(s, list));
    TRY(look_for_guards(s, false, &changed));
    if (!changed)
        TRY(split_costly(s, &changed));
    TRY(search_prove(s));
    if (!changed && s->bound < s->count && s->bound == before) {
        TRY(go_on(s, list, &changed));
        TRY(search_prove(s));
    }
    return STARG_OK;
}

starg_status search_prove_by_leaves(search *s) {
    starg_status status = STARG_OK;
    row_list list = {0};
    if (s->bound == s->count || starg_time_is_over(context_of(s)))
        return STARG_OK;
    s->finest = INFINITY;
    STARG_TRY(row_list_make(context_of(s), 2 * s->points.count + s->cells.count, &list));
    s->odd_rounds = 0;
    for (bool changed = true; changed;) {
        STARG_TRY(search_find_prices(s, &list));
        STARG_TRY(search_prove(s));
        STARG_TRY(search_find_odd(s, &list, &changed));
    }
done:
    row_list_free(context_of(s), &list);
    return status;
}
