/* SPDX-License-Identifier: Apache-2.0 */
/* The paper's four reductions [YL11, 3.3], generalized to demands, and the modes in which they
 * hold.
 *
 * A column j demands demand(j) of the rows that contain it; R(j) are these rows.
 *
 * (1) Essential rows: if demand(j) = |R(j)|, every cover takes all of R(j). Taking row i lowers the
 *     demand of each of its columns by one; columns of demand 0 are covered. Holds for full covers;
 *     with a partial target column j may stay uncovered.
 * (2) Row dominance: let D be the largest demand among the columns of row i. If D other rows
 *     contain all columns of i, then i is redundant: a choice with i either lacks one of these
 *     rows, which can replace i, or has all D, which cover each column of i without it. With demand
 *     1 this is the paper's rule; with larger demands the paper's rule would lose covers that need
 *     both rows. No column gets uncovered, so it holds in every mode.
 * (3) Column dominance: if R(a) is a subset of R(b) and demand(a) >= demand(b), covering a covers
 *     b. So b is redundant for full covers; with a partial target its weight counts.
 * (4) Blocks: connected components of rows and columns are separate problems for full covers; a
 *     partial target or a limit on the rows couples them.
 *
 * Each rule is exact for any instance, so they can be applied in any order and combination. */
#include "cover/cover.h"

static size_t supply(const cover_instance *instance, size_t column) {
    return starg_bit_count(cover_column(instance, column), instance->column_words);
}

static bool is_subset(const uint64_t *a, const uint64_t *b, size_t words) {
    for (size_t w = 0; w < words; w++) {
        if (a[w] & ~b[w])
            return false;
    }
    return true;
}

size_t cover_mark_essential(const cover_instance *instance, uint64_t *rows) {
    for (size_t j = 0; j < instance->columns; j++) {
        if (supply(instance, j) != instance->demands[j])
            continue;
        for (size_t w = 0; w < instance->column_words; w++)
            rows[w] |= cover_column(instance, j)[w];
    }
    return starg_bit_count(rows, instance->column_words);
}

/* Largest demand and rarest column of a row; false if it is empty. */
static bool survey_row(const cover_instance *instance, const size_t *supplies, size_t row,
                       size_t *demand, size_t *rarest) {
    bool any = false;
    *demand = 0;
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, cover_row(instance, row)[w]) {
            size_t column = 64 * w + bit;
            if (instance->demands[column] > *demand)
                *demand = instance->demands[column];
            if (!any || supplies[column] < supplies[*rarest])
                *rarest = column;
            any = true;
        }
    }
    return any;
}

/* True if at least `demand` other rows of the mask hold all columns of `row`. All of them hold its
 * rarest column, so only that column's rows are tested. */
static bool is_needless(const cover_instance *instance, const uint64_t *rows, size_t row,
                        size_t demand, size_t rarest) {
    const uint64_t *bits = cover_row(instance, row), *holders = cover_column(instance, rarest);
    size_t found = 0;
    for (size_t w = 0; w < instance->column_words; w++) {
        STARG_FOR_BITS (bit, holders[w] & rows[w]) {
            size_t other = 64 * w + bit;
            if (other == row || !is_subset(bits, cover_row(instance, other), instance->row_words))
                continue;
            if (++found == demand)
                return true;
        }
    }
    return false;
}

starg_status cover_drop_dominated_rows(cover_run *run, const cover_instance *instance,
                                       uint64_t *rows, size_t *dropped) {
    SCOPED size_t *supplies = NULL;
    *dropped = 0;
    NEW(run->context, "reduce", supplies, instance->columns);
    for (size_t j = 0; j < instance->columns; j++)
        supplies[j] = supply(instance, j);
    /* backward, so that the first of identical rows stays */
    for (size_t i = instance->rows; i-- > 0;) {
        TRY(starg_check_cancel(run->context, "reduce"));
        if (i % 64 == 0 && cover_time_is_over(run))
            break;
        size_t demand, rarest = 0;
        if (survey_row(instance, supplies, i, &demand, &rarest) &&
            !is_needless(instance, rows, i, demand, rarest))
            continue;
        starg_bit_clear(rows, i);
        ++*dropped;
    }
    return STARG_OK;
}

/* Data that column dominance tests before the bits of a column. */
typedef struct column_order {
    uint32_t *by_supply; /* columns, those with few rows first */
    uint32_t *supply;    /* per column */
    uint64_t *signature; /* per column: its bits of 64 sampled rows */
    size_t *row_size;    /* per row: number of its columns */
} column_order;

static void column_order_free(column_order *order) {
    RELEASE(order->by_supply, order->supply, order->signature, order->row_size);
}

static uint64_t sign_column(const cover_instance *instance, size_t column) {
    uint64_t signature = 0;
    for (size_t b = 0; b < 64 && b < instance->rows; b++) {
        size_t row = instance->rows < 64 ? b : b * instance->rows / 64;
        signature |= (uint64_t)starg_bit_test(cover_column(instance, column), row) << b;
    }
    return signature;
}

/* Counting sort by supply; stable. */
static starg_status sort_by_supply(const cover_instance *instance, column_order *order) {
    starg_context *context = instance->context;
    SCOPED size_t *start = NULL;
    NEW_ZERO(context, "reduce", start, instance->rows + 2);
    for (size_t j = 0; j < instance->columns; j++)
        start[order->supply[j] + 1]++;
    for (size_t s = 0; s <= instance->rows; s++)
        start[s + 1] += start[s];
    for (size_t j = 0; j < instance->columns; j++)
        order->by_supply[start[order->supply[j]]++] = (uint32_t)j;
    return STARG_OK;
}

static starg_status column_order_make(const cover_instance *instance, column_order *order) {
    starg_context *context = instance->context;
    *order = (column_order){0};
    NEW(context, "reduce", order->by_supply, instance->columns);
    NEW(context, "reduce", order->supply, instance->columns);
    NEW(context, "reduce", order->signature, instance->columns);
    NEW(context, "reduce", order->row_size, instance->rows);
    for (size_t j = 0; j < instance->columns; j++) {
        order->supply[j] = (uint32_t)supply(instance, j);
        order->signature[j] = sign_column(instance, j);
    }
    for (size_t i = 0; i < instance->rows; i++)
        order->row_size[i] = starg_bit_count(cover_row(instance, i), instance->row_words);
    return sort_by_supply(instance, order);
}

static size_t smallest_row_of(const cover_instance *instance, const column_order *order,
                              size_t column) {
    size_t best = SIZE_MAX;
    for (size_t w = 0; w < instance->column_words; w++) {
        STARG_FOR_BITS (bit, cover_column(instance, column)[w]) {
            size_t row = 64 * w + bit;
            if (best == SIZE_MAX || order->row_size[row] < order->row_size[best])
                best = row;
        }
    }
    return best;
}

/* Clears the columns that contain all rows of `column` and do not demand more. Every row of
 * `column` contains them: scans its smallest row. */
static size_t drop_supersets(const cover_instance *instance, const column_order *order,
                             size_t column, uint64_t *columns) {
    size_t row = smallest_row_of(instance, order, column), dropped = 0;
    if (row == SIZE_MAX)
        return 0;
    uint64_t signature = order->signature[column];
    uint32_t size = order->supply[column], demand = instance->demands[column];
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, cover_row(instance, row)[w] & columns[w]) {
            size_t other = 64 * w + bit;
            if ((signature & ~order->signature[other]) != 0 || order->supply[other] < size ||
                instance->demands[other] > demand || other == column)
                continue;
            if (!is_subset(cover_column(instance, column), cover_column(instance, other),
                           instance->column_words))
                continue;
            starg_bit_clear(columns, other);
            dropped++;
        }
    }
    return dropped;
}

starg_status cover_drop_dominated_columns(cover_run *run, const cover_instance *instance,
                                          uint64_t *columns, size_t *dropped) {
    SCOPED_BY(column_order_free) column_order order = {0};
    *dropped = 0;
    TRY(column_order_make(instance, &order));
    for (size_t k = 0; k < instance->columns; k++) {
        size_t column = order.by_supply[k];
        if (!starg_bit_test(columns, column))
            continue;
        TRY(starg_check_cancel(run->context, "reduce"));
        if (k % 64 == 0 && cover_time_is_over(run))
            break;
        starg_progress_step(run->context, k, instance->columns);
        *dropped += drop_supersets(instance, &order, column, columns);
    }
    return STARG_OK;
}

/* Lowers the demands by the taken rows; clears the columns that are then covered. */
static void serve_columns(cover_instance *instance, const uint64_t *taken, uint64_t *columns) {
    for (size_t j = 0; j < instance->columns; j++) {
        uint32_t given = 0;
        for (size_t w = 0; w < instance->column_words; w++)
            given += (uint32_t)starg_bits_in(cover_column(instance, j)[w] & taken[w]);
        if (given >= instance->demands[j])
            starg_bit_clear(columns, j);
        else
            instance->demands[j] -= given;
    }
}

static starg_status replace_by_part(cover_instance *instance, const uint64_t *rows,
                                    const uint64_t *columns) {
    SCOPED_BY(cover_instance_free) cover_instance part = {0};
    TRY(cover_instance_select(instance, rows, columns, &part));
    cover_instance_free(instance);
    *instance = part;
    part = (cover_instance){0};
    return STARG_OK;
}

starg_status cover_take_rows(cover_instance *instance, const uint64_t *taken, const uint64_t *keep,
                             cover_names *forced) {
    starg_context *context = instance->context;
    SCOPED uint64_t *rows = NULL, *columns = NULL;
    NEW(context, "reduce", rows, instance->column_words);
    NEW(context, "reduce", columns, instance->row_words);
    cover_mask_fill(columns, instance->columns);
    cover_mask_fill(rows, instance->rows);
    for (size_t w = 0; w < instance->column_words; w++) {
        rows[w] &= ~taken[w] & (keep ? keep[w] : UINT64_MAX);
        STARG_FOR_BITS (bit, taken[w])
            PUSH(context, "reduce", forced, instance->row_names[64 * w + bit]);
    }
    serve_columns(instance, taken, columns);
    return replace_by_part(instance, rows, columns);
}

/* Every essential row is paid by one of the columns that make it essential. */
static starg_status price_essentials(const cover_instance *instance, double *prices) {
    SCOPED uint64_t *paid = NULL;
    NEW_ZERO(instance->context, "reduce", paid, instance->column_words);
    for (size_t j = 0; j < instance->columns; j++) {
        if (supply(instance, j) != instance->demands[j])
            continue;
        for (size_t w = 0; w < instance->column_words; w++) {
            uint64_t fresh = cover_column(instance, j)[w] & ~paid[w];
            paid[w] |= fresh;
            if (fresh != 0)
                prices[instance->column_names[j]] = 1;
        }
    }
    return STARG_OK;
}

static starg_status take_essentials(cover_instance *instance, cover_names *forced, double *prices,
                                    bool *changed) {
    starg_context *context = instance->context;
    SCOPED uint64_t *rows = NULL;
    NEW_ZERO(context, "reduce", rows, instance->column_words);
    if (prices != NULL)
        TRY(price_essentials(instance, prices));
    if (cover_mark_essential(instance, rows) != 0) {
        TRY(cover_take_rows(instance, rows, NULL, forced));
        *changed = true;
    }
    return STARG_OK;
}

static starg_status apply_column_dominance(cover_run *run, cover_instance *instance,
                                           bool *changed) {
    SCOPED uint64_t *columns = NULL;
    size_t dropped;
    NEW(run->context, "reduce", columns, instance->row_words);
    cover_mask_fill(columns, instance->columns);
    TRY(cover_drop_dominated_columns(run, instance, columns, &dropped));
    if (dropped != 0) {
        TRY(replace_by_part(instance, NULL, columns));
        *changed = true;
    }
    return STARG_OK;
}

static starg_status apply_row_dominance(cover_run *run, cover_instance *instance, bool *changed) {
    SCOPED uint64_t *rows = NULL;
    size_t dropped;
    NEW(run->context, "reduce", rows, instance->column_words);
    cover_mask_fill(rows, instance->rows);
    TRY(cover_drop_dominated_rows(run, instance, rows, &dropped));
    if (dropped != 0) {
        TRY(cover_instance_keep_rows(instance, rows));
        *changed = true;
    }
    return STARG_OK;
}

static bool every_demand_can_be_met(const cover_instance *instance) {
    for (size_t j = 0; j < instance->columns; j++) {
        if (supply(instance, j) < instance->demands[j])
            return false;
    }
    return true;
}

starg_status cover_reduce_full(cover_run *run, cover_instance *instance, cover_names *forced,
                               double *prices, bool *feasible) {
    IN_STAGE(run->context, "reduce");
    *feasible = every_demand_can_be_met(instance);
    for (bool changed = *feasible; changed;) {
        changed = false;
        TRY(take_essentials(instance, forced, prices, &changed));
        if (cover_time_is_over(run))
            break;
        TRY(apply_column_dominance(run, instance, &changed));
        TRY(apply_row_dominance(run, instance, &changed));
    }
    return STARG_OK;
}

starg_status cover_reduce_partial(cover_run *run, cover_instance *instance) {
    bool changed;
    starg_progress_begin(run->context, "reduce");
    starg_status status = apply_row_dominance(run, instance, &changed);
    starg_progress_end(run->context);
    return status;
}

/* Traversal of the rows and columns of one block. */
typedef struct block_walk {
    const cover_instance *instance;
    uint64_t *unseen; /* columns whose rows are not yet collected */
    uint32_t *block, *queue;
    uint32_t number;
    size_t tail;
} block_walk;

static void reach_row(block_walk *walk, size_t row) {
    if (walk->block[row] != UINT32_MAX)
        return;
    walk->block[row] = walk->number;
    walk->queue[walk->tail++] = (uint32_t)row;
}

static void reach_rows_of(block_walk *walk, size_t column) {
    for (size_t w = 0; w < walk->instance->column_words; w++) {
        STARG_FOR_BITS (bit, cover_column(walk->instance, column)[w])
            reach_row(walk, 64 * w + bit);
    }
}

static void walk_block(block_walk *walk, size_t first) {
    walk->tail = 0;
    reach_row(walk, first);
    for (size_t head = 0; head < walk->tail; head++) {
        const uint64_t *row = cover_row(walk->instance, walk->queue[head]);
        for (size_t w = 0; w < walk->instance->row_words; w++) {
            uint64_t fresh = row[w] & walk->unseen[w];
            walk->unseen[w] &= ~fresh;
            STARG_FOR_BITS (bit, fresh)
                reach_rows_of(walk, 64 * w + bit);
        }
    }
}

starg_status cover_find_blocks(const cover_instance *instance, uint32_t *block, size_t *count) {
    starg_status status = STARG_OK;
    starg_context *context = instance->context;
    block_walk walk = {.instance = instance, .block = block};
    *count = 0;
    STARG_NEW(context, "reduce", walk.unseen, instance->row_words);
    STARG_NEW(context, "reduce", walk.queue, instance->rows);
    cover_mask_fill(walk.unseen, instance->columns);
    for (size_t i = 0; i < instance->rows; i++)
        block[i] = UINT32_MAX;
    for (size_t i = 0; i < instance->rows; i++) {
        if (block[i] != UINT32_MAX)
            continue;
        walk.number = (uint32_t)(*count)++;
        walk_block(&walk, i);
    }
done:
    RELEASE(walk.unseen, walk.queue);
    return status;
}
