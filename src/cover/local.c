/* SPDX-License-Identifier: Apache-2.0 */
/* Local search with column weights, after Gao, Weise and Li (An efficient local search heuristic
 * with row weighting for the unicost set covering problem, EJOR 246, 2015), generalized to demands.
 * Whenever everything is covered, that is the new best cover, and the chosen row of least loss is
 * removed. Each step then
 *   1. removes the chosen row of least loss;
 *   2. picks a random column that lacks rows and adds the row of largest gain among its rows;
 *   3. increments the weight of every column that still lacks rows, which drives the search to
 *      columns that it keeps missing.
 * Ties go to the row that has not moved for longest. A row just added stays for the next step; one
 * just removed does not return in the same step.
 *
 * score(i) is the gain of an unchosen row and the loss of a chosen one: the sum of the weights of
 * its columns with held < demand, or with held <= demand. A move changes only the scores of rows of
 * columns whose count crosses their demand.
 *
 * Cost of a step: the ones of two rows, and the ones of the columns that change. The limits are
 * counts, so that the result is the same on every machine. */
#include "cover/cover.h"

#include "core/rng.h"

/* Without a better cover the search ends after this many steps per row, or this much work. */
static const uint64_t PATIENT_STEPS = 50;
static const uint64_t PATIENT_WORK = 100000000; /* some tenths of a second */
static const uint64_t SHORT_WORK = 20000000;    /* where there is nothing else */
static const uint64_t WORK_PER_CHECK = 2000000; /* between checks of the clock */

typedef struct local_search {
    const cover_instance *instance;
    cover_state at;
    uint64_t *score;  /* per row */
    uint64_t *weight; /* per column */
    uint64_t *moved;  /* per row: step of its last move, 0: none */
    uint64_t step, work;
    starg_rng rng;
} local_search;

/* Adds `change`, modulo 2^64, to the scores of a column's chosen or unchosen rows. */
static void shift_scores(local_search *search, size_t column, bool chosen, uint64_t change) {
    const uint64_t *holders = cover_column(search->instance, column);
    for (size_t w = 0; w < search->instance->column_words; w++) {
        uint64_t taken = search->at.taken[w];
        STARG_FOR_BITS (bit, holders[w] & (chosen ? taken : ~taken)) {
            search->score[64 * w + bit] += change;
            search->work++;
        }
    }
    search->work += search->instance->column_words;
}

/* Updates the scores just before an unchosen `row` is added (direction -1: the others' losses) or
 * just after it was removed (+1: they get them back). Its own score is its loss or gain in both
 * cases: it loses nothing where held <= demand after the addition, which is held < demand before
 * it. */
static void update_scores(local_search *search, size_t row, uint64_t direction) {
    const cover_instance *instance = search->instance;
    uint64_t own = search->score[row];
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, cover_row(instance, row)[w]) {
            size_t column = 64 * w + bit;
            uint32_t held = search->at.held[column], demand = instance->demands[column];
            if (held + 1 == demand)
                shift_scores(search, column, false, direction * search->weight[column]);
            else if (held == demand)
                shift_scores(search, column, true, direction * search->weight[column]);
            search->work++;
        }
    }
    search->score[row] = own;
    search->work += instance->row_words;
}

static void add_row(local_search *search, size_t row) {
    update_scores(search, row, (uint64_t)-1);
    cover_state_add(&search->at, row);
    search->moved[row] = search->step;
}

static void remove_at(local_search *search, size_t position) {
    size_t row = search->at.rows[position];
    cover_state_remove(&search->at, position);
    update_scores(search, row, 1);
    search->moved[row] = search->step;
}

static bool moved_earlier(const local_search *search, size_t a, size_t b) {
    return search->moved[a] != search->moved[b] ? search->moved[a] < search->moved[b] : a < b;
}

/* Position of the chosen row to remove: least loss, then longest unmoved, then lowest index; rows
 * added after step `since` stay. SIZE_MAX if all of them do. */
static size_t choose_to_remove(local_search *search, uint64_t since) {
    const uint32_t *rows = search->at.rows;
    const uint64_t *score = search->score;
    size_t best = SIZE_MAX;
    for (size_t p = 0; p < search->at.count; p++) {
        if (search->moved[rows[p]] > since)
            continue;
        if (best == SIZE_MAX || score[rows[p]] < score[rows[best]] ||
            (score[rows[p]] == score[rows[best]] && moved_earlier(search, rows[p], rows[best])))
            best = p;
    }
    search->work += search->at.count;
    return best;
}

/* The row of a column to add: largest gain, same tie-breaking; SIZE_MAX if none is allowed. */
static size_t choose_to_add(local_search *search, size_t column) {
    const uint64_t *holders = cover_column(search->instance, column);
    size_t best = SIZE_MAX;
    for (size_t w = 0; w < search->instance->column_words; w++) {
        STARG_FOR_BITS (bit, holders[w] & ~search->at.taken[w]) {
            size_t row = 64 * w + bit;
            search->work++;
            if (search->moved[row] == search->step)
                continue;
            if (best == SIZE_MAX || search->score[row] > search->score[best] ||
                (search->score[row] == search->score[best] && moved_earlier(search, row, best)))
                best = row;
        }
    }
    return best;
}

/* A random column that lacks rows; there must be one. */
static size_t choose_open(local_search *search) {
    const uint64_t *open = search->at.open;
    size_t words = search->instance->row_words, w = 0;
    uint64_t left = starg_rng_below(&search->rng, starg_bit_count(open, words));
    search->work += words;
    for (;; w++) {
        uint64_t here = starg_bits_in(open[w]);
        if (left < here)
            break;
        left -= here;
    }
    uint64_t word = open[w];
    for (; left != 0; left--)
        word &= word - 1;
    return 64 * w + (size_t)starg_bit_lowest(word);
}

/* Increments the weights of open columns, and updates scores. */
static void raise_weights(local_search *search) {
    for (size_t w = 0; w < search->instance->row_words; w++) {
        STARG_FOR_BITS (bit, search->at.open[w]) {
            size_t column = 64 * w + bit;
            search->weight[column]++;
            shift_scores(search, column, false, 1);
            shift_scores(search, column, true, 1);
        }
    }
}

static void take_step(local_search *search) {
    search->step++;
    size_t out = choose_to_remove(search, search->step - 2);
    if (out != SIZE_MAX)
        remove_at(search, out);
    size_t in = choose_to_add(search, choose_open(search));
    if (in != SIZE_MAX)
        add_row(search, in);
    raise_weights(search);
}

/* Records a full cover; drops rows of least loss until it is no longer full. */
static void record_cover(local_search *search, cover_state *best) {
    while (search->at.weight == search->instance->total && search->at.count != 0) {
        cover_state_copy(best, &search->at);
        remove_at(search, choose_to_remove(search, UINT64_MAX));
    }
}

static starg_status prepare(local_search *search, const cover_state *best) {
    const cover_instance *instance = search->instance;
    TRY(cover_state_create(instance, &search->at));
    NEW_ZERO(instance->context, "cover", search->score, instance->rows);
    NEW(instance->context, "cover", search->weight, instance->columns);
    NEW_ZERO(instance->context, "cover", search->moved, instance->rows);
    cover_state_copy(&search->at, best);
    for (size_t j = 0; j < instance->columns; j++) {
        search->weight[j] = 1;
        if (search->at.held[j] < instance->demands[j])
            shift_scores(search, j, false, 1);
        if (search->at.held[j] <= instance->demands[j])
            shift_scores(search, j, true, 1);
    }
    return STARG_OK;
}

static starg_status iterate(cover_run *run, local_search *search, size_t enough,
                            cover_state *best) {
    uint64_t check = 0, last_work = search->work, last_step = search->step;
    uint64_t patience = run->local ? SHORT_WORK : PATIENT_WORK;
    record_cover(search, best);
    while (best->count > enough && search->work - last_work < patience &&
           search->step - last_step < PATIENT_STEPS * search->instance->rows) {
        if (search->work >= check) {
            starg_status status = starg_check_cancel(run->context, "cover");
            if (status != STARG_OK || cover_time_is_over(run))
                return status;
            check = search->work + WORK_PER_CHECK;
        }
        size_t before = best->count;
        take_step(search);
        record_cover(search, best);
        if (best->count < before) {
            last_work = search->work;
            last_step = search->step;
        }
    }
    return STARG_OK;
}

starg_status cover_local_search(cover_run *run, size_t enough, cover_state *best) {
    starg_status status = STARG_OK;
    local_search search = {.instance = best->instance, .rng = starg_rng_make(1, 1, 0), .step = 1};
    if (best->count <= enough || best->instance->columns == 0)
        return STARG_OK;
    STARG_TRY(prepare(&search, best));
    STARG_TRY(iterate(run, &search, enough, best));
done:
    cover_state_free(&search.at);
    RELEASE(search.score, search.weight, search.moved);
    return status;
}
