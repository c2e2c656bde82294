/* SPDX-License-Identifier: Apache-2.0 */
/* Depth-first branch and bound. A node has chosen and excluded rows; its candidates are scored in
 * two ways, each of which bounds what further rows can add:
 *   - need: the weight of the open columns of the row (a column that becomes covered is open and in
 *     an added row);
 *   - price: the sum of the root's multipliers over the row's open columns; the open columns then
 *     keep what they do not pay (see weight_bound.c, with demands lowered by the chosen rows).
 * The tighter one sorts the candidates by decreasing score. Child t takes candidate t and excludes
 * those before it, so its bound is the node's base plus the scores t to t + left - 1: it decreases
 * with t, and the first child that cannot beat the incumbent ends the node. */
#include "cover/cover.h"

enum { STEPS_PER_NODE = 4096 };

typedef struct search {
    cover_run *run;
    const cover_instance *instance;
    const cover_weight_bound *bound;
    cover_state *at, *best;
    uint64_t incumbent, goal;
    size_t nodes_left;
    cover_wide steps_left;
    bool stopped; /* by a limit */
} search;

typedef struct branching {
    cover_score *candidates;
    size_t count;
    cover_wide base; /* scaled bound without further rows */
} branching;

static bool is_over(search *seek) {
    cover_wide cost = (cover_wide)seek->instance->rows * (cover_wide)seek->instance->row_words;
    if (seek->nodes_left == 0 || seek->steps_left < cost || cover_time_is_over(seek->run)) {
        seek->stopped = true;
        return true;
    }
    seek->nodes_left--;
    starg_progress_step(seek->run->context, seek->run->max_nodes - seek->nodes_left,
                        seek->run->max_nodes);
    seek->steps_left -= cost;
    seek->run->nodes++;
    return false;
}

static void note_incumbent(search *seek) {
    if (seek->at->weight <= seek->incumbent)
        return;
    seek->incumbent = seek->at->weight;
    cover_state_copy(seek->best, seek->at);
}

/* The scaled bound of a branching if `left` rows may be added from candidate `first` on. */
static cover_wide bound_from(const branching *branch, size_t first, size_t left) {
    cover_wide sum = branch->base;
    for (size_t t = first; t < branch->count && t < first + left; t++)
        sum += branch->candidates[t].score;
    return sum;
}

static void score_by_need(const search *seek, branching *branch) {
    unsigned shift = seek->bound->shift;
    branch->base = (cover_wide)seek->at->weight << shift;
    for (size_t t = 0; t < branch->count; t++) {
        cover_score *candidate = &branch->candidates[t];
        candidate->score = cover_state_need(seek->at, candidate->row) << shift;
    }
    cover_sort_scores(branch->candidates, branch->count);
}

static uint64_t price_row(const search *seek, size_t row) {
    const uint64_t *bits = cover_row(seek->instance, row);
    uint64_t sum = 0;
    for (size_t w = 0; w < seek->instance->row_words; w++) {
        STARG_FOR_BITS (bit, bits[w] & seek->at->open[w])
            sum += seek->bound->multipliers[64 * w + bit];
    }
    return sum;
}

static void score_by_price(const search *seek, branching *branch) {
    const cover_instance *instance = seek->instance;
    const cover_state *at = seek->at;
    branch->base = (cover_wide)at->weight << seek->bound->shift;
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, at->open[w]) {
            size_t column = 64 * w + bit;
            uint64_t lacking = instance->demands[column] - at->held[column];
            branch->base += (instance->weights[column] << seek->bound->shift) -
                            lacking * seek->bound->multipliers[column];
        }
    }
    for (size_t t = 0; t < branch->count; t++) {
        cover_score *candidate = &branch->candidates[t];
        candidate->score = price_row(seek, candidate->row);
    }
    cover_sort_scores(branch->candidates, branch->count);
}

/* Scores the candidates by the measure with the tighter bound. */
static void score(const search *seek, branching *branch, size_t left) {
    score_by_price(seek, branch);
    cover_wide by_price = bound_from(branch, 0, left);
    score_by_need(seek, branch);
    if (by_price < bound_from(branch, 0, left))
        score_by_price(seek, branch);
}

static bool can_beat(const search *seek, cover_wide scaled) {
    return scaled >> seek->bound->shift > (cover_wide)seek->incumbent;
}

/* Explores the node at `seek->at` with the given candidates; at most K levels deep. */
static starg_status explore(search *seek, const cover_score *candidates, size_t count) {
    size_t left = seek->bound->rows - seek->at->count;
    SCOPED cover_score *sorted = NULL;
    TRY(starg_check_cancel(seek->run->context, "ilp"));
    if (is_over(seek))
        return STARG_OK;
    note_incumbent(seek);
    if (left == 0)
        return STARG_OK;
    NEW(seek->run->context, "ilp", sorted, count);
    for (size_t t = 0; t < count; t++)
        sorted[t] = candidates[t];
    branching branch = {.candidates = sorted, .count = count};
    score(seek, &branch, left);
    for (size_t t = 0; t < count && !seek->stopped && seek->incumbent < seek->goal; t++) {
        if (!can_beat(seek, bound_from(&branch, t, left)))
            break;
        cover_state_add(seek->at, sorted[t].row);
        TRY(explore(seek, sorted + t + 1, count - t - 1));
        cover_state_remove(seek->at, seek->at->count - 1);
    }
    return STARG_OK;
}

starg_status cover_search(cover_run *run, const cover_instance *instance,
                          const cover_weight_bound *bound, uint64_t floor, uint64_t goal,
                          cover_state *best, bool *exhausted) {
    SCOPED_BY(cover_state_free) cover_state at = {0};
    SCOPED cover_score *all = NULL;
    search seek = {.run = run,
                   .instance = instance,
                   .bound = bound,
                   .at = &at,
                   .best = best,
                   .incumbent = floor > best->weight ? floor : best->weight,
                   .goal = goal,
                   .nodes_left = run->max_nodes,
                   .steps_left = (cover_wide)run->max_nodes * STEPS_PER_NODE};
    *exhausted = false;
    IN_STAGE(run->context, "ilp");
    TRY(cover_state_create(instance, &at));
    NEW(run->context, "ilp", all, instance->rows);
    for (size_t i = 0; i < instance->rows; i++)
        all[i] = (cover_score){0, (uint32_t)i};
    TRY(explore(&seek, all, instance->rows));
    *exhausted = !seek.stopped;
    return STARG_OK;
}
