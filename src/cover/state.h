/* SPDX-License-Identifier: Apache-2.0 */
/* A changing choice of rows, and what each row would add or remove.
 *
 * Invariants: held[j] is the number of chosen rows that hold column j; the masks say open: held <
 * demand, last: held == demand - 1 (one more row covers it), exact: held == demand (one row less
 * uncovers it). Adding or removing a row costs O(ones of the row). */
#pragma once

#include "cover/instance.h"

typedef struct cover_state {
    const cover_instance *instance;
    uint32_t *held;
    uint64_t *open, *last, *exact; /* masks of columns */
    uint64_t *taken;               /* mask of rows */
    uint32_t *rows;                /* the chosen rows, unordered */
    size_t count;
    uint64_t weight; /* of the covered columns */
} cover_state;

/* Creates a state without rows. Errors: MEMORY. */
starg_status cover_state_create(const cover_instance *instance, cover_state *out);
void cover_state_free(cover_state *state);

void cover_state_clear(cover_state *state);
void cover_state_copy(cover_state *to, const cover_state *from); /* of the same instance */
void cover_state_add(cover_state *state, size_t row);
void cover_state_remove(cover_state *state,
                        size_t position); /* index into `rows`; the last one moves there */

/* Sum of the weights of the columns of a row that are in the mask. */
uint64_t cover_weight_of(const cover_instance *instance, size_t row, const uint64_t *mask);

/* Weight of the columns of a row that still lack rows: never grows while rows are added. */
static inline uint64_t cover_state_need(const cover_state *state, size_t row) {
    return cover_weight_of(state->instance, row, state->open);
}

/* Weight that adding a row would cover at once. */
static inline uint64_t cover_state_gain(const cover_state *state, size_t row) {
    return cover_weight_of(state->instance, row, state->last);
}

/* Weight that removing a chosen row would uncover. */
static inline uint64_t cover_state_loss(const cover_state *state, size_t row) {
    return cover_weight_of(state->instance, row, state->exact);
}

/* Replaces `names` by the names of the chosen rows. Errors: MEMORY. */
starg_status cover_state_names(const cover_state *state, cover_names *names);
