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
 * The program starts with rows of high value at the previous prices, and without witnesses that had
 * no price; a row left out is added once it exceeds 1, a witness once the cover holds too little of
 * it. Odd sets of witnesses (guard/odd_sets.h) have prices like witnesses. */
#include <math.h>

#include "guard/search_parts.h"

static const char STAGE[] = "search";

/* PROGRAMS is a safeguard: prices that are not found to the end are scaled down, and of little use.
 * COMPARISONS and VALUES of rows take as long as a test of a witness. */
enum { PROGRAMS = 30, COMPARISONS = 150, VALUES = 5, ODD_ROUNDS = 5 };

/* The least share of a fractional cover that counts. */
static const double LEAST_SHARE = 1e-6;

/* Leaves below this value did not hold the previous prices down. */
static const double BINDING = 0.98;

/* Of a witness that stays in the program. */
static const double LEAST_PRICE = 1e-4;

/* Of the sum of prices, between two searches for odd sets. */
static const double LEAST_CHANGE = 5e-3;

bool search_is_fine(const search *s, const search_cell *leaf) {
    return cell_length(&leaf->box) <= s->finest;
}

static void list_fine(search *s, double least, const witness_row *among, row_list *list) {
    uint64_t compared = 0;
    for (size_t i = 0; i < s->cells.count && s->finest > 0; i++) {
        const search_cell *cell = &s->cells.data[i];
        if (cell->children != 0 || !search_is_fine(s, cell) || search_worth(s, &cell->open) < least)
            continue;
        compared += list->count;
        if (!is_needless(list, &cell->open, among)) {
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
            most = fmax(most, search_worth(s, &s->cells.data[i].open));
    return most;
}

bool search_fine_bind(const search *s, const row_list *list) {
    for (size_t i = 0; i < list->count; i++)
        if (list->points[i] == UINT32_MAX && s->prices.share[i] > LEAST_SHARE)
            return true;
    return false;
}

/* Adds points worth at least `least` to the list, with those that see a witness none of it sees. */
static void list_worthy(const search *s, double least, const uint8_t *listed,
                        const witness_row *among, row_list *list) {
    witness_row held = {{0}};
    for (size_t i = 0; i < s->points.count; i++)
        if (!listed[i] && search_worth(s, &s->points.data[i].seen) >= least &&
            !is_needless(list, &s->points.data[i].seen, among))
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
        most = fmax(most, search_worth(s, &s->points.data[i].seen));
    return most;
}

/* ---- witnesses without a price ---- */

static witness_row priced_witnesses(const search *s) {
    witness_row wanted = all_witnesses(s);
    for (int w = 0; w < WITNESS_WORDS; w++)
        wanted.bits[w] &= ~s->unpriced.bits[w];
    return wanted;
}

/* With those of the odd sets. */
static witness_row among_and_odd(const search *s, const witness_row *wanted) {
    witness_row among = *wanted;
    for (size_t k = 0; k < s->odd.count; k++)
        for (size_t i = 0; i < s->odd.set[k].count; i++)
            starg_bit_set(among.bits, s->odd.set[k].witness[i]);
    return among;
}

/* Idle witnesses of which the fractional cover holds too little get prices again. False: none. */
static bool wake_witnesses(search *s, const row_list *list) {
    double held[MOST_WITNESSES] = {0};
    bool any = false;
    for (size_t i = 0; i < list->count; i++)
        for (size_t w = 0; w < WITNESS_WORDS; w++)
            STARG_FOR_BITS (bit, list->rows[i]->bits[w] & s->unpriced.bits[w])
                held[64 * w + bit] += s->prices.share[i];
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        if (starg_bit_test(s->unpriced.bits, j) && held[j] < 1 - SEARCH_GAP) {
            starg_bit_clear(s->unpriced.bits, j);
            any = true;
        }
    return any;
}

static void rest_witnesses(search *s) {
    for (size_t j = 0; j < s->scene.witnesses.count; j++)
        if (s->prices.price[j] < LEAST_PRICE)
            starg_bit_set(s->unpriced.bits, j);
}

starg_status search_find_odd(search *s, const row_list *list, bool *changed) {
    size_t added = 0;
    const odd_sets_question question = {list->rows, s->prices.share, list->count, s->prices.price};
    *changed = false;
    if (s->redundancy > 1 || s->odd_rounds == ODD_ROUNDS ||
        fabs(search_value(s) - s->odd_value) < LEAST_CHANGE) {
        s->odd_rounds = 0;
        return STARG_OK;
    }
    s->odd_value = search_value(s);
    s->odd_rounds++;
    TRY(odd_sets_renew(context_of(s), &question, &s->odd, s->prices.odd, &added, &s->scene.work));
    *changed = added > 0;
    return STARG_OK;
}

starg_status search_find_prices(search *s, row_list *list) {
    starg_context *context = context_of(s);
    SCOPED uint8_t *listed = NULL;
    double most = 1;
    uint64_t before = s->scene.work;
    NEW_ZERO(context, STAGE, listed, s->points.count);
    double least = s->prices.sum > 0 ? 0.8 : 0;
    list->count = 0;
    for (int k = 0; k < PROGRAMS; k++) {
        const witness_row wanted = priced_witnesses(s), among = among_and_odd(s, &wanted);
        list_fine(s, k == 0 ? fmax(least, BINDING) : least, &among, list);
        list_worthy(s, least, listed, &among, list);
        for (size_t i = 0; i < list->count; i++)
            if (list->points[i] != UINT32_MAX)
                listed[list->points[i]] = 1;
        prices_free(&s->prices);
        TRY(prices_find(context, list->rows, list->count, &wanted, &s->odd, &s->prices));
        s->scene.work += s->prices.work;
        most = search_largest_value(s);
        least = 1 + 1e-9;
        if (!wake_witnesses(s, list) && fmax(most, largest_fine(s)) < 1 + SEARCH_GAP)
            break;
    }
    rest_witnesses(s);
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        s->prices.price[j] /= most;
    for (size_t k = 0; k < s->odd.count; k++)
        s->prices.odd[k] /= most;
    s->prices.sum /= most;
    s->prices.work = s->scene.work - before;
    return STARG_OK;
}
