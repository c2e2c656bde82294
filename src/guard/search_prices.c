/* SPDX-License-Identifier: Apache-2.0 */
/* Prices of a search: from its points, and from cells that are small.
 *
 * A point of a cell sees no more than the cell may see, so prices by which no cell exceeds 1 prove
 * their sum as a bound. Points alone do not lead there: the cells about a point where two faces
 * meet, as at a reflex edge, may see what is seen on either side, however small they are, and
 * prices that rest on this are never proven. So leaves no longer than `finest` are rows of the
 * program like points: the prices do without what only a smaller cell would show. They prove less
 * than those of the points at first, and the loop of the search (guard/search.c) halves `finest`
 * while that matters.
 *
 * The program starts with rows of high value at the previous prices; a row left out is added once
 * it exceeds 1. */
#include <math.h>

#include "guard/search_parts.h"

static const char STAGE[] = "search";

/* Comparisons and values of rows that take as long as a test of a witness. */
enum { PROGRAMS = 6, COMPARISONS = 100, VALUES = 4 };

/* The least share of a fractional cover that counts. */
static const double LEAST_SHARE = 1e-6;

/* Leaves below this value did not hold the previous prices down. */
static const double BINDING = 0.98;

bool search_is_fine(const search *s, const search_cell *leaf) {
    return cell_length(&leaf->box) <= s->finest;
}

static void list_fine(search *s, double least, row_list *list) {
    uint64_t compared = 0;
    for (size_t i = 0; i < s->cells.count && s->finest > 0; i++) {
        const search_cell *cell = &s->cells.data[i];
        if (cell->children != 0 || !search_is_fine(s, cell) ||
            row_value(&cell->open, s->prices.price) < least)
            continue;
        compared += list->count;
        if (!is_needless(list, &cell->open)) {
            list->points[list->count] = UINT32_MAX;
            list->rows[list->count++] = &cell->open;
        }
    }
    s->scene.work += compared / COMPARISONS + s->cells.count / VALUES;
}

static double largest_fine(search *s) {
    double most = 0;
    s->scene.work += s->cells.count / VALUES;
    for (size_t i = 0; i < s->cells.count && s->finest > 0; i++)
        if (s->cells.data[i].children == 0 && search_is_fine(s, &s->cells.data[i]))
            most = fmax(most, row_value(&s->cells.data[i].open, s->prices.price));
    return most;
}

bool search_fine_bind(const search *s, const row_list *list) {
    for (size_t i = 0; i < list->count; i++)
        if (list->points[i] == UINT32_MAX && s->prices.share[i] > LEAST_SHARE)
            return true;
    return false;
}

/* Adds points worth at least `least` to the list, with those that see a witness none of it sees. */
static void list_worthy(const search *s, double least, const uint8_t *listed, row_list *list) {
    witness_row held = {{0}};
    for (size_t i = 0; i < s->points.count; i++)
        if (!listed[i] && row_value(&s->points.data[i].seen, s->prices.price) >= least &&
            !is_needless(list, &s->points.data[i].seen))
            row_list_add(s, list, i);
    for (size_t k = 0; k < list->count; k++)
        for (int w = 0; w < WITNESS_WORDS; w++)
            held.bits[w] |= list->rows[k]->bits[w];
    for (size_t i = 0; i < s->points.count; i++)
        if (!row_is_within(&s->points.data[i].seen, &held))
            row_list_add(s, list, i);
}

double search_largest_value(const search *s) {
    double most = 1;
    for (size_t i = 0; i < s->points.count; i++)
        most = fmax(most, row_value(&s->points.data[i].seen, s->prices.price));
    return most;
}

starg_status search_find_prices(search *s, row_list *list) {
    starg_status status = STARG_OK;
    starg_context *context = context_of(s);
    uint8_t *listed = NULL;
    const witness_row all = all_witnesses(s);
    double most = 1;
    uint64_t before = s->scene.work;
    STARG_NEW_ZERO(context, STAGE, listed, s->points.count);
    double least = s->prices.sum > 0 ? 0.8 : 0;
    list->count = 0;
    for (int k = 0; k < PROGRAMS; k++) {
        list_fine(s, k == 0 ? fmax(least, BINDING) : least, list);
        list_worthy(s, least, listed, list);
        for (size_t i = 0; i < list->count; i++)
            if (list->points[i] != UINT32_MAX)
                listed[list->points[i]] = 1;
        prices_free(context, &s->prices);
        STARG_TRY(prices_find(context, list->rows, list->count, &all, &s->prices));
        s->scene.work += s->prices.work;
        most = search_largest_value(s);
        least = 1 + 1e-9;
        if (fmax(most, largest_fine(s)) < 1 + SEARCH_GAP)
            break;
    }
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        s->prices.price[j] /= most;
    s->prices.sum /= most;
    s->prices.work = s->scene.work - before;
done:
    starg_release(context, listed);
    return status;
}
