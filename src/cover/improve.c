/* SPDX-License-Identifier: Apache-2.0 */
/* Swap search: each chosen row in turn is replaced by the row that covers most in its place, if
 * that gains. Every swap raises the covered weight, so the search terminates; rounds are limited
 * too. Cost of a round: chosen rows x the whole matrix, by words. */
#include "cover/cover.h"

enum { MOST_ROUNDS = 20 };

static size_t best_to_add(const cover_state *state, uint64_t *gain) {
    size_t best = SIZE_MAX;
    *gain = 0;
    for (size_t i = 0; i < state->instance->rows; i++) {
        if (starg_bit_test(state->taken, i))
            continue;
        uint64_t own = cover_state_gain(state, i);
        if (own > *gain) {
            *gain = own;
            best = i;
        }
    }
    return best;
}

/* Puts the best row at a position; true if that covers more. */
static bool swap_at(cover_state *state, size_t position) {
    uint32_t out = state->rows[position];
    uint64_t before = state->weight, gain;
    cover_state_remove(state, position);
    size_t in = best_to_add(state, &gain);
    bool better = in != SIZE_MAX && state->weight + gain > before;
    cover_state_add(state, better ? in : out);
    /* the new row is last, and the former last is at the position: exchange them */
    size_t last = state->count - 1;
    uint32_t moved = state->rows[position];
    state->rows[position] = state->rows[last];
    state->rows[last] = moved;
    return better;
}

starg_status cover_swap(cover_run *run, cover_state *state, uint64_t goal) {
    bool better = true;
    for (int round = 0; round < MOST_ROUNDS && better; round++) {
        better = false;
        for (size_t position = 0; position < state->count; position++) {
            starg_status status = starg_check_cancel(run->context, "cover");
            if (status != STARG_OK || state->weight >= goal || cover_time_is_over(run))
                return status;
            better |= swap_at(state, position);
        }
    }
    return STARG_OK;
}
