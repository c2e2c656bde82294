/* SPDX-License-Identifier: Apache-2.0 */
/* A changing choice of rows, and what each row would add or remove.
 *
 * Invariants: held[j] is the number of chosen rows that hold column j; the masks say open: held <
 * demand, last: held == demand - 1 (one more row covers it), exact: held == demand (one row less
 * uncovers it). Adding or removing a row costs O(ones of the row). */
#include "cover/cover.h"

starg_status cover_state_create(const cover_instance *instance, cover_state *out) {
    starg_context *context = instance->context;
    *out = (cover_state){.instance = instance};
    NEW(context, "cover", out->held, instance->columns);
    NEW(context, "cover", out->open, instance->row_words);
    NEW(context, "cover", out->last, instance->row_words);
    NEW(context, "cover", out->exact, instance->row_words);
    NEW(context, "cover", out->taken, instance->column_words);
    NEW(context, "cover", out->rows, instance->rows);
    cover_state_clear(out);
    return STARG_OK;
}

void cover_state_free(cover_state *state) {
    if (state->instance == NULL)
        return;
    RELEASE(state->held, state->open, state->last, state->exact, state->taken, state->rows);
    *state = (cover_state){0};
}

static void classify(cover_state *state, size_t column) {
    uint64_t bit = (uint64_t)1 << (column % 64);
    size_t word = column / 64;
    uint32_t held = state->held[column], demand = state->instance->demands[column];
    state->open[word] &= ~bit;
    state->last[word] &= ~bit;
    state->exact[word] &= ~bit;
    if (held < demand)
        state->open[word] |= bit;
    if (held + 1 == demand)
        state->last[word] |= bit;
    if (held == demand)
        state->exact[word] |= bit;
}

void cover_state_clear(cover_state *state) {
    const cover_instance *instance = state->instance;
    for (size_t w = 0; w < instance->row_words; w++)
        state->open[w] = state->last[w] = state->exact[w] = 0;
    for (size_t w = 0; w < instance->column_words; w++)
        state->taken[w] = 0;
    state->count = 0;
    state->weight = 0;
    for (size_t j = 0; j < instance->columns; j++) {
        state->held[j] = 0;
        classify(state, j);
    }
}

static void copy_words(uint64_t *to, const uint64_t *from, size_t count) {
    for (size_t w = 0; w < count; w++)
        to[w] = from[w];
}

void cover_state_copy(cover_state *to, const cover_state *from) {
    const cover_instance *instance = from->instance;
    for (size_t j = 0; j < instance->columns; j++)
        to->held[j] = from->held[j];
    copy_words(to->open, from->open, instance->row_words);
    copy_words(to->last, from->last, instance->row_words);
    copy_words(to->exact, from->exact, instance->row_words);
    copy_words(to->taken, from->taken, instance->column_words);
    for (size_t i = 0; i < from->count; i++)
        to->rows[i] = from->rows[i];
    to->count = from->count;
    to->weight = from->weight;
}

void cover_state_add(cover_state *state, size_t row) {
    const cover_instance *instance = state->instance;
    const uint64_t *bits = cover_row(instance, row);
    state->weight += cover_state_gain(state, row);
    state->rows[state->count++] = (uint32_t)row;
    starg_bit_set(state->taken, row);
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, bits[w]) {
            state->held[64 * w + bit]++;
            classify(state, 64 * w + bit);
        }
    }
}

void cover_state_remove(cover_state *state, size_t position) {
    const cover_instance *instance = state->instance;
    size_t row = state->rows[position];
    const uint64_t *bits = cover_row(instance, row);
    state->weight -= cover_state_loss(state, row);
    state->rows[position] = state->rows[--state->count];
    starg_bit_clear(state->taken, row);
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, bits[w]) {
            state->held[64 * w + bit]--;
            classify(state, 64 * w + bit);
        }
    }
}

uint64_t cover_weight_of(const cover_instance *instance, size_t row, const uint64_t *mask) {
    const uint64_t *bits = cover_row(instance, row);
    uint64_t sum = 0;
    COVER_FOR_WORDS(w, instance, row)
    STARG_FOR_BITS (bit, bits[w] & mask[w])
        sum += instance->weights[64 * w + bit];
    return sum;
}

starg_status cover_state_names(const cover_state *state, cover_names *names) {
    starg_context *context = state->instance->context;
    names->count = 0;
    for (size_t i = 0; i < state->count; i++)
        PUSH(context, "cover", names, state->instance->row_names[state->rows[i]]);
    return STARG_OK;
}
