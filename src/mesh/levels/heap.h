/* SPDX-License-Identifier: Apache-2.0 */
/* Priority queue over the items 0 to n - 1 with mutable keys. */
#pragma once

#include "core/memory.h"

typedef struct heap_entry {
    double key;
    uint32_t item;
} heap_entry;

typedef struct mesh_heap {
    starg_context *context;
    size_t count;        /* items in the queue */
    heap_entry *entries; /* binary heap; ties go to the lower item */
    uint32_t *slot;      /* per item its index in entries, or HEAP_NONE */
} mesh_heap;

#define HEAP_NONE UINT32_MAX

/* Creates an empty queue for items below `items` (below 2^32 - 1). Errors: MEMORY. */
starg_status heap_create(starg_context *context, size_t items, mesh_heap **out)
    STARG_PRIVATE(heap_create);
void heap_free(mesh_heap *heap) STARG_PRIVATE(heap_free);
STARG_DROP(heap, mesh_heap)

/* Inserts an item or changes its key; keys are not NaN. O(log n). */
void heap_set(mesh_heap *heap, uint32_t item, double key) STARG_PRIVATE(heap_set);
/* Removes an item if present. O(log n). */
void heap_remove(mesh_heap *heap, uint32_t item) STARG_PRIVATE(heap_remove);
/* Removes the item with the lowest key; false if the queue is empty. */
bool heap_pop(mesh_heap *heap, uint32_t *item) STARG_PRIVATE(heap_pop);

static inline bool heap_contains(const mesh_heap *heap, uint32_t item) {
    return heap->slot[item] != HEAP_NONE;
}
