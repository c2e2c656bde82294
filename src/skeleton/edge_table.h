/* SPDX-License-Identifier: Apache-2.0 */
/* Edge numbering: a hash table from vertex pairs to numbers, in order of insertion. */
#pragma once

#include "core/memory.h"
#include "core/rng.h"

#define EDGE_NONE UINT32_MAX

typedef struct edge_table {
    uint64_t *keys; /* 0: free; key 0 never occurs, since the ends differ */
    uint32_t *numbers;
    size_t mask;
    uint32_t count;
} edge_table;

/* Room for `capacity` edges. Errors: MEMORY (stage named). */
static inline starg_status edge_table_make(starg_context *context, const char *stage,
                                           size_t capacity, edge_table *table) {
    size_t slots = 16;
    while (slots < 2 * capacity)
        slots *= 2;
    *table = (edge_table){.mask = slots - 1};
    NEW_ZERO(context, stage, table->keys, slots);
    NEW(context, stage, table->numbers, slots);
    return STARG_OK;
}

static inline void edge_table_free(edge_table *table) {
    RELEASE(table->keys, table->numbers);
}

static inline size_t edge_table_slot(const edge_table *table, uint32_t u, uint32_t v) {
    uint64_t key = u < v ? (uint64_t)u << 32 | v : (uint64_t)v << 32 | u;
    size_t slot = starg_hash64(key) & table->mask;
    while (table->keys[slot] != 0 && table->keys[slot] != key)
        slot = (slot + 1) & table->mask;
    return slot;
}

/* The number of an edge, or EDGE_NONE. */
static inline uint32_t edge_table_find(const edge_table *table, uint32_t u, uint32_t v) {
    size_t slot = edge_table_slot(table, u, v);
    return table->keys[slot] != 0 ? table->numbers[slot] : EDGE_NONE;
}

/* The number of an edge; a new edge gets the next number. */
static inline uint32_t edge_table_number(edge_table *table, uint32_t u, uint32_t v) {
    size_t slot = edge_table_slot(table, u, v);
    if (table->keys[slot] == 0) {
        table->keys[slot] = u < v ? (uint64_t)u << 32 | v : (uint64_t)v << 32 | u;
        table->numbers[slot] = table->count++;
    }
    return table->numbers[slot];
}
