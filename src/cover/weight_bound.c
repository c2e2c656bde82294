/* SPDX-License-Identifier: Apache-2.0 */
#include "cover/weight_bound.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_STEPS = 300, STEPS_PER_REVIEW = 10, MOST_SHIFT = 20 };

static int compare_scores(const void *a, const void *b) {
    const cover_score *x = a, *y = b;
    if (x->score != y->score)
        return x->score > y->score ? -1 : 1;
    return (x->row > y->row) - (x->row < y->row);
}

void cover_sort_scores(cover_score *scores, size_t count) {
    qsort(scores, count, sizeof *scores, compare_scores);
}

/* The sum of the multipliers of a row's columns. What a point sees lies together, so that most
 * words are empty or full; of a word that is nearly full, what is missing is taken off. */
static uint64_t row_sum(const cover_instance *instance, const cover_weight_bound *bound,
                        const uint64_t *row) {
    uint64_t sum = 0;
    for (size_t w = 0; w < instance->row_words; w++) {
        const uint64_t *trial = bound->trial + 64 * w;
        uint64_t word = row[w];
        if (word == 0)
            continue;
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

/* What the columns keep, and the rows' scores in falling order. */
static cover_wide evaluate(const cover_instance *instance, cover_weight_bound *bound) {
    cover_wide kept = 0;
    memset(bound->word_sums, 0, instance->row_words * sizeof *bound->word_sums);
    for (size_t j = 0; j < instance->columns; j++) {
        kept += (instance->weights[j] << bound->shift) - bound->trial[j] * instance->demands[j];
        bound->word_sums[j / 64] += bound->trial[j];
    }
    for (size_t i = 0; i < instance->rows; i++)
        bound->scores[i] =
            (cover_score){row_sum(instance, bound, cover_row(instance, i)), (uint32_t)i};
    cover_sort_scores(bound->scores, instance->rows);
    return kept;
}

uint64_t cover_weight_bound_take(const cover_instance *instance, cover_weight_bound *bound) {
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
    return limit;
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
    starg_status status = STARG_OK;
    starg_context *context = instance->context;
    *out = (cover_weight_bound){.goal = goal};
    STARG_NEW(context, "bound", out->multipliers, instance->columns);
    STARG_NEW(context, "bound", out->trial, instance->columns);
    STARG_NEW(context, "bound", out->word_sums, instance->row_words);
    STARG_NEW(context, "bound", out->scores, instance->rows);
    while (out->shift < MOST_SHIFT && instance->total >> (61 - out->shift) == 0)
        out->shift++;
    cover_weight_bound_restart(instance, out, rows);
done:
    if (status != STARG_OK)
        cover_weight_bound_free(instance, out);
    return status;
}

void cover_weight_bound_free(const cover_instance *instance, cover_weight_bound *bound) {
    starg_release(instance->context, bound->multipliers);
    starg_release(instance->context, bound->trial);
    starg_release(instance->context, bound->word_sums);
    starg_release(instance->context, bound->scores);
    *bound = (cover_weight_bound){0};
}

/* The subgradient of U at the trial multipliers: chosen rows that hold a column, less its demand
 * while the column is worth covering. Returns its length in the metric of the weights. */
static double find_slope(const cover_instance *instance, const cover_weight_bound *bound,
                         double *slope) {
    double square = 0;
    for (size_t j = 0; j < instance->columns; j++)
        slope[j] = 0;
    for (size_t k = 0; k < bound->rows && k < instance->rows; k++) {
        const uint64_t *row = cover_row(instance, bound->scores[k].row);
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, row[w])
                slope[64 * w + bit] += 1;
        }
    }
    for (size_t j = 0; j < instance->columns; j++) {
        double demand = instance->demands[j];
        bool full = bound->trial[j] >= cover_largest_multiplier(instance, bound, j);
        slope[j] -= demand;
        if ((full && slope[j] < 0) || (bound->trial[j] == 0 && slope[j] > 0))
            slope[j] = 0; /* the step would leave the box */
        square += (double)instance->weights[j] * slope[j] * slope[j];
    }
    return square;
}

/* Down the slope by factor x gap / square, in the metric of the weights, inside the box. */
static void take_step(const cover_instance *instance, cover_weight_bound *bound,
                      const double *slope, double length) {
    double scale = (double)((uint64_t)1 << bound->shift);
    for (size_t j = 0; j < instance->columns; j++) {
        double step = length * scale * (double)instance->weights[j] * slope[j];
        bound->trial[j] = cover_near_multiplier(instance, bound, j, (double)bound->trial[j] - step);
    }
}

starg_status cover_weight_bound_improve(cover_run *run, const cover_instance *instance,
                                        uint64_t enough, cover_weight_bound *bound) {
    starg_status status = STARG_OK;
    double *slope = NULL;
    double factor = 1;
    uint64_t reviewed = bound->most;
    starg_progress_begin(run->context, "bound");
    STARG_NEW(run->context, "bound", slope, instance->columns);
    for (size_t j = 0; j < instance->columns; j++)
        bound->trial[j] = bound->multipliers[j];
    uint64_t value = cover_weight_bound_take(instance, bound);
    for (size_t step = 1; step <= MOST_STEPS && bound->most > enough; step++) {
        STARG_TRY(starg_check_cancel(run->context, "bound"));
        if (cover_time_is_over(run))
            break;
        starg_progress_step(run->context, step, MOST_STEPS);
        double square = find_slope(instance, bound, slope);
        if (square == 0)
            break; /* a minimum */
        double gap = (double)(value - enough) + 1e-3 * (double)instance->total;
        take_step(instance, bound, slope, factor * gap / square);
        value = cover_weight_bound_take(instance, bound);
        if (step % STEPS_PER_REVIEW == 0) {
            if (bound->most >= reviewed)
                factor *= 0.5;
            reviewed = bound->most;
        }
    }
done:
    starg_progress_end(run->context);
    starg_release(run->context, slope);
    return status;
}
