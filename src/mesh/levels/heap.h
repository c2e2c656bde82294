/* SPDX-License-Identifier: Apache-2.0 */
/* A priority queue over the items 0 to n - 1 whose keys may change. */
#ifndef STARG_MESH_LEVELS_HEAP_H
#define STARG_MESH_LEVELS_HEAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/context.h"
#include "core/private.h"

typedef struct heap_entry {
    double key;
    uint32_t item;
} heap_entry;

typedef struct mesh_heap {
    starg_context *context;
    size_t count;        /* items in the queue                        */
    heap_entry *entries; /* a binary heap; ties go to the lower item  */
    uint32_t *slot;      /* per item its place in entries, or HEAP_NONE */
} mesh_heap;

#define HEAP_NONE UINT32_MAX

/* An empty queue for items below `items` (below 2^32 - 1). Errors: MEMORY. */
starg_status heap_create(starg_context *context, size_t items, mesh_heap **out)
    STARG_PRIVATE(heap_create);
void heap_free(mesh_heap *heap) STARG_PRIVATE(heap_free);

/* Enters an item, or changes its key; keys are not NaN. O(log n). */
void heap_set(mesh_heap *heap, uint32_t item, double key) STARG_PRIVATE(heap_set);
/* Takes an item out, if it is there. O(log n). */
void heap_remove(mesh_heap *heap, uint32_t item) STARG_PRIVATE(heap_remove);
/* Takes out the item of the lowest key; false when there is none. */
bool heap_pop(mesh_heap *heap, uint32_t *item) STARG_PRIVATE(heap_pop);

static inline bool heap_contains(const mesh_heap *heap, uint32_t item) {
    return heap->slot[item] != HEAP_NONE;
}

#endif
