/* SPDX-License-Identifier: Apache-2.0 */
/* The candidates of a large model that are carried to the model itself.
 *
 * Problem: a row of a million faces costs as much as a hundred of a level of detail, and most
 * candidates have better ones beside them that see the same.
 *
 * Method: the proxy level tells what each candidate sees. Carried are the fewest candidates that
 * see enough of it, and a little more. Besides, by the weight of what they see, the largest first,
 * each candidate is carried unless those carried so before it see each region that it sees (as many
 * of them as are to see each face); less than a FAINT share of what may stay unseen is no region.
 * Candidates that the level cannot judge, since they see nothing of it, are carried. So a face of
 * the level keeps the candidates that see most besides it.
 *
 * Cost: a row of the level for each candidate, and a cover. */
#include "guard/stages.h"

#include <stdlib.h>

static const char STAGE[] = "guard";

static const double FAINT = 0.05, MORE = 0.1; /* shares of what may stay unseen */

typedef struct ranked {
    uint64_t weight;
    size_t index;
} ranked;

static int by_weight(const void *left, const void *right) {
    const ranked *a = left, *b = right;
    int order = (a->weight < b->weight) - (a->weight > b->weight);
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

/* The weight of what a candidate sees that fewer than `enough` see. */
static uint64_t weigh(const starg_bits *rows, size_t row, const column_weights *weights,
                      const uint32_t *seen, size_t enough) {
    uint64_t sum = 0;
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, starg_bits_row(rows, row)[w]) {
            if (seen[64 * w + bit] < enough)
                sum += weights->weights[64 * w + bit];
        }
    return sum;
}

static void note(const starg_bits *rows, size_t row, uint32_t *seen) {
    for (size_t w = 0; w < rows->words; w++)
        STARG_FOR_BITS (bit, starg_bits_row(rows, row)[w]) {
            seen[64 * w + bit]++;
        }
}

/* The fewest for the level. */
static starg_status carry_cover(const guard_pool *pool, const column_weights *weights,
                                uint8_t *carried) {
    starg_cover *cover = NULL;
    const choice how = {.method = STARG_COVER_ILP, .max_nodes = pool->options->max_nodes};
    starg_status status = choose_candidates(pool, weights, &how, &cover);
    for (size_t i = 0; status == STARG_OK && i < cover->count; i++)
        carried[cover->rows[i]] = 1;
    starg_cover_free(cover);
    return status;
}

static starg_status carry_others(const guard_pool *pool, const column_weights *weights,
                                 uint32_t *seen, uint8_t *carried) {
    const starg_bits *rows = pool->rows;
    const starg_guard_options *o = pool->options;
    SCOPED ranked *order = NULL;
    SCOPED uint32_t *none = NULL;
    uint64_t faint = (uint64_t)(FAINT * (1 - o->coverage) * (double)weights->total);
    NEW(pool->context, STAGE, order, rows->rows);
    NEW_ZERO(pool->context, STAGE, none, rows->columns);
    for (size_t i = 0; i < rows->rows; i++)
        order[i] = (ranked){weigh(rows, i, weights, none, 1), i};
    qsort(order, rows->rows, sizeof *order, by_weight);
    for (size_t i = 0; i < rows->rows; i++) {
        size_t row = order[i].index;
        if (order[i].weight == 0 || weigh(rows, row, weights, seen, o->redundancy) > faint) {
            carried[row] = 1;
            note(rows, row, seen);
        }
    }
    return STARG_OK;
}

static void keep_carried(const guard_pool *pool, const uint8_t *carried, candidate_points *points) {
    points->data.count = 0; /* the pool has them all, but for a time limit */
    for (size_t i = 0; i < pool_count(pool); i++)
        if (carried[i]) {
            memcpy(points->data.data + points->data.count, pool_point(pool, i),
                   3 * sizeof *points->data.data);
            points->data.count += 3;
        }
}

starg_status carry_candidates(const guard_problem *problem, const starg_solid *level,
                              candidate_points *points) {
    starg_context *context = problem->context;
    starg_guard_options options = *problem->options;
    SCOPED_BY(pool_free) guard_pool pool = {0};
    SCOPED_BY(column_weights_free) column_weights weights = {0};
    SCOPED uint32_t *seen = NULL;
    SCOPED uint8_t *carried = NULL;
    options.coverage += MORE * (1 - options.coverage);
    TRY(pool_create(context, level, &options, &pool));
    TRY(pool_add(&pool, points));
    if (pool_count(&pool) == 0)
        return STARG_OK;
    TRY(column_weights_create(context, level, options.visibility.target, &weights));
    NEW_ZERO(context, STAGE, seen, pool.columns);
    NEW_ZERO(context, STAGE, carried, pool_count(&pool));
    TRY(carry_cover(&pool, &weights, carried));
    TRY(carry_others(&pool, &weights, seen, carried));
    keep_carried(&pool, carried, points);
    return STARG_OK;
}
