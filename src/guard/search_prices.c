/* SPDX-License-Identifier: Apache-2.0 */
/* Prices of a search: from its points, and from cells that are small.
 *
 * A point of a cell sees no more than the cell may see, so prices by which no cell exceeds 1 prove
 * their sum as a bound. Points alone do not lead there: the cells about a point where two faces
 * meet, as at a reflex edge, may see what is seen on either side, however small they are, and
 * prices that rest on this are never proven. So leaves no longer than `finest` are rows of the
 * program like points: the prices do without what only a smaller cell would show. They prove less
 * than those of the points at first, and the proof (guard/search_proof.c) halves `finest` while
 * that matters.
 *
 * The program starts with rows of high value at the previous prices, and without witnesses that had
 * no price; a row left out is added once it exceeds 1, a witness once the cover holds too little of
 * it. Odd sets of witnesses (guard/odd_sets.c) have prices like witnesses. */
#include <math.h>

#include "geometry/vec3.h"
#include "guard/search_parts.h"

static const char STAGE[] = "search";

/* PROGRAMS is a safeguard: prices that are not found to the end are scaled down, and of little use.
 * COMPARISONS and VALUES of rows take as long as a test of a witness. */
enum { PROGRAMS = 30, COMPARISONS = 150, VALUES = 5, ODD_ROUNDS = 5, OTHERS_TURN = 3 };

/* The least share of a fractional cover that counts. */
static const double LEAST_SHARE = 1e-6;

/* Leaves below this value did not hold the previous prices down. */
static const double BINDING = 0.98;

/* Of a witness that stays in the program. */
static const double LEAST_PRICE = 1e-4;

/* Of the sum of prices, between two searches for odd sets. */
static const double LEAST_CHANGE = 5e-3;

static bool is_fine(const search_duals *d, const search_cell *leaf) {
    return cell_length(&leaf->box) <= d->finest;
}

/* ---- lists of rows ---- */

/* Of the rows in a block, those that hold all witnesses of `row` in `among`. Two or three witnesses
 * rule out nearly all rows. */
static uint64_t holders_of(const row_block *block, const witness_row *row,
                           const witness_row *among) {
    uint64_t holders = UINT64_MAX;
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w] & among->bits[w]) {
            holders &= block->holders[64 * w + bit];
            if (holders == 0)
                return 0;
        }
    return holders;
}

bool row_list_holds(const row_list *list, const witness_row *row, const witness_row *among) {
    for (size_t b = 0; 64 * b < list->count; b++) {
        const size_t left = list->count - 64 * b;
        const uint64_t all = left < 64 ? (UINT64_C(1) << left) - 1 : UINT64_MAX;
        if ((holders_of(&list->blocks.data[b], row, among) & all) != 0)
            return true;
    }
    return false;
}

starg_status row_list_make(const search_duals *d, row_list *out) {
    size_t most = 2 * d->points->count + d->cells->count;
    out->context = d->witnesses->scene.context;
    NEW(out->context, STAGE, out->rows, most);
    NEW(out->context, STAGE, out->names, most);
    return STARG_OK;
}

starg_status row_list_add(row_list *list, const witness_row *row, size_t name) {
    const size_t number = list->count / 64, at = list->count % 64;
    if (number == list->blocks.count)
        PUSH(list->context, STAGE, &list->blocks, (row_block){{0}});
    row_block *block = &list->blocks.data[number];
    if (at == 0)
        memset(block, 0, sizeof *block);
    for (size_t w = 0; w < WITNESS_WORDS; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            starg_bit_set(&block->holders[64 * w + bit], at);
    list->rows[list->count] = row;
    list->names[list->count++] = (uint32_t)name;
    return STARG_OK;
}

void row_list_free(row_list *list) {
    RELEASE(list->rows, list->names, list->blocks.data);
}

static starg_status list_fine(const search_duals *d, double least, const witness_row *among,
                              row_list *list, uint64_t *work) {
    uint64_t compared = 0;
    for (size_t i = 0; i < d->cells->count && d->finest > 0; i++) {
        const search_cell *cell = &d->cells->data[i];
        if (cell->children != 0 || !is_fine(d, cell) || duals_of_row(d, &cell->open) < least)
            continue;
        compared += list->count;
        if (!row_list_holds(list, &cell->open, among))
            TRY(row_list_add(list, &cell->open, ROW_LEAF + i));
    }
    *work += compared / COMPARISONS + d->cells->count / VALUES;
    return STARG_OK;
}

/* Adds points worth at least `least` to the list, with those that see a witness none of it sees. */
static starg_status list_worthy(const search_duals *d, double least, const uint8_t *listed,
                                const witness_row *among, row_list *list) {
    witness_row held = {{0}};
    for (size_t i = 0; i < d->points->count; i++)
        if (!listed[i] && duals_of_row(d, &d->points->data[i].seen) >= least &&
            !row_list_holds(list, &d->points->data[i].seen, among))
            TRY(row_list_add(list, &d->points->data[i].seen, i));
    for (size_t k = 0; k < list->count; k++)
        for (int w = 0; w < WITNESS_WORDS; w++)
            held.bits[w] |= list->rows[k]->bits[w];
    for (size_t i = 0; i < d->points->count; i++)
        if (!row_is_within(&d->points->data[i].seen, &held))
            TRY(row_list_add(list, &d->points->data[i].seen, i));
    return STARG_OK;
}

/* ---- leaves ---- */

starg_status duals_list_leaves(const search_duals *d, double most, size_t first, leaf_list *list,
                               uint64_t *work) {
    for (size_t i = first; i < d->cells->count; i++) {
        const search_cell *cell = &d->cells->data[i];
        if (cell->children != 0 || is_fine(d, cell))
            continue;
        double value = duals_of_row(d, &cell->open);
        if (value <= most)
            continue;
        double size = vec3_distance(cell->box.lower, cell->box.upper);
        scored_leaf leaf = {(value - most) * sqrt(size), (uint32_t)i};
        PUSH(d->witnesses->scene.context, STAGE, list, leaf);
    }
    *work += (d->cells->count - first) / VALUES;
    return STARG_OK;
}

static double largest_fine(const search_duals *d, uint64_t *work) {
    double most = 0;
    *work += d->cells->count / VALUES;
    for (size_t i = 0; i < d->cells->count && d->finest > 0; i++)
        if (d->cells->data[i].children == 0 && is_fine(d, &d->cells->data[i]))
            most = fmax(most, duals_of_row(d, &d->cells->data[i].open));
    return most;
}

double duals_of_best_point(const search_duals *d) {
    double most = 1;
    for (size_t i = 0; i < d->points->count; i++)
        most = fmax(most, duals_of_row(d, &d->points->data[i].seen));
    return most;
}

void duals_set_finest(search_duals *d, double finest) {
    if (finest > d->finest)
        d->odd_rounds = 0;
    d->finest = finest;
}

bool duals_are_held(search_duals *d, const row_list *list, bool *others) {
    bool held = false;
    for (size_t i = 0; i < list->count && !held; i++)
        held = list->names[i] >= ROW_LEAF && d->prices.share[i] > LEAST_SHARE;
    if (held)
        d->refinements++;
    *others = !held || d->refinements % OTHERS_TURN == 0;
    return held;
}

/* ---- witnesses without a price ---- */

static witness_row priced_witnesses(const search_duals *d) {
    witness_row wanted = search_scene_witnesses(&d->witnesses->scene, 0);
    for (int w = 0; w < WITNESS_WORDS; w++)
        wanted.bits[w] &= ~d->unpriced.bits[w];
    return wanted;
}

/* With those of the odd sets. */
static witness_row among_and_odd(const search_duals *d, const witness_row *wanted) {
    witness_row among = *wanted;
    for (size_t k = 0; k < d->odd.count; k++)
        for (size_t i = 0; i < d->odd.set[k].count; i++)
            starg_bit_set(among.bits, d->odd.set[k].witness[i]);
    return among;
}

/* Idle witnesses of which the fractional cover holds too little get prices again. False: none. */
static bool wake_witnesses(search_duals *d, const row_list *list) {
    double held[MOST_WITNESSES] = {0};
    bool any = false;
    for (size_t i = 0; i < list->count; i++)
        for (size_t w = 0; w < WITNESS_WORDS; w++)
            STARG_FOR_BITS (bit, list->rows[i]->bits[w] & d->unpriced.bits[w])
                held[64 * w + bit] += d->prices.share[i];
    for (size_t j = 0; j < d->witnesses->scene.witnesses.count; j++)
        if (starg_bit_test(d->unpriced.bits, j) && held[j] < 1 - SEARCH_GAP) {
            starg_bit_clear(d->unpriced.bits, j);
            any = true;
        }
    return any;
}

starg_status duals_find_odd(search_duals *d, const row_list *list, bool *changed, uint64_t *work) {
    size_t added = 0;
    const odd_sets_question question = {list->rows, d->prices.share, list->count, d->prices.price};
    *changed = false;
    if (d->witnesses->redundancy > 1 || d->odd_rounds == ODD_ROUNDS ||
        fabs(duals_value(d) - d->odd_value) < LEAST_CHANGE) {
        d->odd_rounds = 0;
        return STARG_OK;
    }
    d->odd_value = duals_value(d);
    d->odd_rounds++;
    TRY(odd_sets_renew(d->witnesses->scene.context, &question, &d->odd, d->prices.odd, &added,
                       work));
    *changed = added > 0;
    return STARG_OK;
}

starg_status duals_find(search_duals *d, row_list *list, uint64_t *work) {
    starg_context *context = d->witnesses->scene.context;
    SCOPED uint8_t *listed = NULL;
    double most = 1;
    uint64_t before = *work;
    NEW_ZERO(context, STAGE, listed, d->points->count);
    double least = d->prices.sum > 0 ? 0.8 : 0;
    list->count = 0;
    for (int k = 0; k < PROGRAMS; k++) {
        const witness_row wanted = priced_witnesses(d), among = among_and_odd(d, &wanted);
        TRY(list_fine(d, k == 0 ? fmax(least, BINDING) : least, &among, list, work));
        TRY(list_worthy(d, least, listed, &among, list));
        for (size_t i = 0; i < list->count; i++)
            if (list->names[i] < ROW_LEAF)
                listed[list->names[i]] = 1;
        prices_free(&d->prices);
        TRY(prices_find(context, list->rows, list->count, &wanted, &d->odd, &d->prices));
        *work += d->prices.work;
        most = duals_of_best_point(d);
        least = 1 + 1e-9;
        if (!wake_witnesses(d, list) && fmax(most, largest_fine(d, work)) < 1 + SEARCH_GAP)
            break;
    }
    for (size_t j = 0; j < d->witnesses->scene.witnesses.count; j++)
        if (d->prices.price[j] < LEAST_PRICE)
            starg_bit_set(d->unpriced.bits, j);
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        d->prices.price[j] /= most;
    for (size_t k = 0; k < d->odd.count; k++)
        d->prices.odd[k] /= most;
    d->prices.sum /= most;
    d->prices.work = *work - before;
    return STARG_OK;
}
