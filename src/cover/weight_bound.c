/* SPDX-License-Identifier: Apache-2.0 */
/* Upper bound on the weight that K rows can cover, in integers; conversely a lower bound on the
 * rows needed for a weight.
 *
 * For any multipliers u >= 0, K rows cover at most
 *     U(K, u) = sum_j max(0, w(j) - demand(j) u(j)) + the K largest sums of u over a row:
 * a covered column pays demand(j) u(j) to its chosen rows and keeps the rest. So the smallest K
 * with U(K, u) >= T is a proven lower bound for covering the weight T. Weights and multipliers are
 * scaled by 2^shift, chosen so that the scaled weights sum to below 2^62. */
#include "cover/cover.h"

#include <stdlib.h>

enum { MOST_SHIFT = 20 };

static int compare_scores(const void *a, const void *b) {
    const cover_score *x = a, *y = b;
    if (x->score != y->score)
        return x->score > y->score ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

void cover_sort_scores(cover_score *scores, size_t count) {
    qsort(scores, count, sizeof *scores, compare_scores);
}

/* Sum of the multipliers of a row's columns. Columns seen from one point are contiguous, so most
 * words are empty or full; for a nearly full word, the missing columns are subtracted. */
static uint64_t row_sum(const cover_instance *instance, const cover_weight_bound *bound,
                        size_t row) {
    uint64_t sum = 0;
    COVER_FOR_WORDS(w, instance, row) {
        const uint64_t *trial = bound->trial + 64 * w;
        uint64_t word = cover_row(instance, row)[w];
        if (starg_bit_count(&word, 1) <= 32 || instance->columns - 64 * w < 64) {
            STARG_FOR_BITS (bit, word)
                sum += trial[bit];
        } else {
            sum += bound->word_sums[w];
            STARG_FOR_BITS (bit, ~word)
                sum -= trial[bit];
        }
    }
    return sum;
}

/* What the columns keep; sorts the rows' scores in decreasing order. */
static cover_wide evaluate(const cover_instance *instance, cover_weight_bound *bound) {
    cover_wide kept = 0;
    memset(bound->word_sums, 0, instance->row_words * sizeof *bound->word_sums);
    for (size_t j = 0; j < instance->columns; j++) {
        kept += (instance->weights[j] << bound->shift) - bound->trial[j] * instance->demands[j];
        bound->word_sums[j / 64] += bound->trial[j];
    }
    for (size_t i = 0; i < instance->rows; i++)
        bound->scores[i] = (cover_score){row_sum(instance, bound, i), (uint32_t)i};
    cover_sort_scores(bound->scores, instance->rows);
    return kept;
}

void cover_weight_bound_take(const cover_instance *instance, cover_weight_bound *bound) {
    cover_wide sum = evaluate(instance, bound);
    cover_wide goal = (cover_wide)bound->goal << bound->shift;
    cover_wide most = sum;
    size_t least = 0;
    for (size_t k = 0; k < instance->rows; k++) {
        if (sum < goal)
            least = k + 1;
        sum += bound->scores[k].score;
        if (k < bound->rows)
            most = sum;
    }
    if (least > bound->least)
        bound->least = least;
    most >>= bound->shift;
    uint64_t limit = most < (cover_wide)instance->total ? (uint64_t)most : instance->total;
    if (limit < bound->most) {
        bound->most = limit;
        for (size_t j = 0; j < instance->columns; j++)
            bound->multipliers[j] = bound->trial[j];
    }
}

void cover_weight_bound_restart(const cover_instance *instance, cover_weight_bound *bound,
                                size_t rows) {
    bound->rows = rows;
    bound->most = UINT64_MAX;
    for (size_t j = 0; j < instance->columns; j++)
        bound->trial[j] = cover_largest_multiplier(instance, bound, j);
    cover_weight_bound_take(instance, bound);
}

starg_status cover_weight_bound_create(const cover_instance *instance, size_t rows, uint64_t goal,
                                       cover_weight_bound *out) {
    starg_context *context = instance->context;
    *out = (cover_weight_bound){.goal = goal};
    NEW(context, "bound", out->multipliers, instance->columns);
    NEW(context, "bound", out->trial, instance->columns);
    NEW(context, "bound", out->word_sums, instance->row_words);
    NEW(context, "bound", out->scores, instance->rows);
    while (out->shift < MOST_SHIFT && instance->total >> (61 - out->shift) == 0)
        out->shift++;
    cover_weight_bound_restart(instance, out, rows);
    return STARG_OK;
}

void cover_weight_bound_free(cover_weight_bound *bound) {
    RELEASE(bound->multipliers, bound->trial, bound->word_sums, bound->scores);
    *bound = (cover_weight_bound){0};
}
