/* SPDX-License-Identifier: Apache-2.0 */
/* Heap that tracks the slot of each item. Four children a slot: they are neighbours in memory, and
 * the levels are half of a binary heap's. */
#include "mesh/levels/heap.h"

enum { CHILDREN = 4 };

starg_status heap_create(starg_context *context, size_t items, mesh_heap **out) {
    SCOPED_BY(heap_drop) mesh_heap *heap = NULL;
    *out = NULL;
    NEW_ZERO(context, "simplify", heap, 1);
    heap->context = context;
    NEW(context, "simplify", heap->entries, items);
    NEW(context, "simplify", heap->slot, items);
    for (size_t i = 0; i < items; i++)
        heap->slot[i] = HEAP_NONE;
    *out = heap;
    heap = NULL;
    return STARG_OK;
}

void heap_free(mesh_heap *heap) {
    if (heap == NULL)
        return;
    RELEASE(heap->entries, heap->slot, heap);
}

static bool before(heap_entry a, heap_entry b) {
    return a.key != b.key ? a.key < b.key : a.item < b.item;
}

static void put(mesh_heap *heap, size_t slot, heap_entry entry) {
    heap->entries[slot] = entry;
    heap->slot[entry.item] = (uint32_t)slot;
}

/* Moves an entry up from a free slot. */
static void rise(mesh_heap *heap, size_t slot, heap_entry entry) {
    while (slot > 0 && before(entry, heap->entries[(slot - 1) / CHILDREN])) {
        put(heap, slot, heap->entries[(slot - 1) / CHILDREN]);
        slot = (slot - 1) / CHILDREN;
    }
    put(heap, slot, entry);
}

/* Moves an entry down from a free slot. */
static void sink(mesh_heap *heap, size_t slot, heap_entry entry) {
    for (;;) {
        size_t first = CHILDREN * slot + 1, least = first;
        for (size_t child = first + 1; child < first + CHILDREN && child < heap->count; child++)
            if (before(heap->entries[child], heap->entries[least]))
                least = child;
        if (least >= heap->count || !before(heap->entries[least], entry))
            break;
        put(heap, slot, heap->entries[least]);
        slot = least;
    }
    put(heap, slot, entry);
}

static void settle(mesh_heap *heap, size_t slot, heap_entry entry) {
    if (slot > 0 && before(entry, heap->entries[(slot - 1) / CHILDREN]))
        rise(heap, slot, entry);
    else
        sink(heap, slot, entry);
}

void heap_set(mesh_heap *heap, uint32_t item, double key) {
    size_t slot = heap_contains(heap, item) ? heap->slot[item] : heap->count++;
    settle(heap, slot, (heap_entry){key, item});
}

void heap_remove(mesh_heap *heap, uint32_t item) {
    if (!heap_contains(heap, item))
        return;
    size_t slot = heap->slot[item];
    heap_entry last = heap->entries[--heap->count];
    heap->slot[item] = HEAP_NONE;
    if (slot < heap->count)
        settle(heap, slot, last);
}

bool heap_pop(mesh_heap *heap, uint32_t *item) {
    if (heap->count == 0)
        return false;
    *item = heap->entries[0].item;
    heap_remove(heap, *item);
    return true;
}
