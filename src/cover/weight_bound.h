/* SPDX-License-Identifier: Apache-2.0 */
/* Upper bound on the weight that K rows can cover, in integers; conversely a lower bound on the
 * rows needed for a weight.
 *
 * For any multipliers u >= 0, K rows cover at most
 *     U(K, u) = sum_j max(0, w(j) - demand(j) u(j)) + the K largest sums of u over a row:
 * a covered column pays demand(j) u(j) to its chosen rows and keeps the rest. So the smallest K
 * with U(K, u) >= T is a proven lower bound for covering the weight T. Weights and multipliers are
 * scaled by 2^shift, chosen so that the scaled weights sum to below 2^62. */
#pragma once

#include "cover/state.h"

/* A row with the sum of its multipliers. */
typedef struct cover_score {
    uint64_t score;
    uint32_t row;
} cover_score;

/* Sorts by score, largest first, ties by index. */
void cover_sort_scores(cover_score *scores, size_t count);

typedef struct cover_weight_bound {
    unsigned shift;
    uint64_t *multipliers; /* of the lowest bound found for `rows` rows */
    size_t rows;           /* K */
    uint64_t most;         /* no K rows cover more */
    uint64_t goal;         /* T */
    size_t least;          /* no fewer rows cover T */
    uint64_t *trial;       /* scratch: multipliers, their sums by 64, scores */
    uint64_t *word_sums;
    cover_score *scores;
} cover_weight_bound;

/* The largest useful multiplier: a covered column keeps nothing. */
static inline uint64_t cover_largest_multiplier(const cover_instance *instance,
                                                const cover_weight_bound *bound, size_t column) {
    return (instance->weights[column] << bound->shift) / instance->demands[column];
}

/* A scaled number, clamped to between 0 and the largest multiplier; 0 for NaN. */
static inline uint64_t cover_near_multiplier(const cover_instance *instance,
                                             const cover_weight_bound *bound, size_t column,
                                             double value) {
    uint64_t largest = cover_largest_multiplier(instance, bound, column);
    return !(value > 0) ? 0 : value >= (double)largest ? largest : (uint64_t)value;
}

/* Bounds for `rows` rows and for the weight `goal`, from u(j) = w(j) / demand(j): the sum of the
 * heaviest rows. Errors: MEMORY. */
starg_status cover_weight_bound_create(const cover_instance *instance, size_t rows, uint64_t goal,
                                       cover_weight_bound *out);
void cover_weight_bound_free(cover_weight_bound *bound);

/* Changes the number of rows; bounds for the goal stay. */
void cover_weight_bound_restart(const cover_instance *instance, cover_weight_bound *bound,
                                size_t rows);

/* Applies the trial multipliers' bounds, and sorts the rows' scores by them. */
void cover_weight_bound_take(const cover_instance *instance, cover_weight_bound *bound);

/* Improves both by the linear relaxation: of the fewest rows for the goal, until `least` is at
 * least `enough`, or of the most weight for `rows` rows, until `most` is at most `enough`. A
 * failing solver or the time limit never worsens them. Errors: MEMORY, CANCELLED. */
starg_status cover_weight_bound_relax(cover_run *run, const cover_instance *instance, bool by_goal,
                                      uint64_t enough, cover_weight_bound *bound);
