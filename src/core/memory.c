/* SPDX-License-Identifier: Apache-2.0 */
#include "core/memory.h"

#include <stdlib.h>

/* Precedes every block. Its size keeps the block aligned for any type. */
typedef union block_header {
    struct {
        size_t bytes;
        starg_context *context;
    } of;
    max_align_t align;
} block_header;

static void count_up(starg_context *context, size_t bytes) {
    size_t live = atomic_fetch_add(&context->live_bytes, bytes) + bytes;
    size_t peak = atomic_load(&context->peak_bytes);
    while (live > peak && !atomic_compare_exchange_weak(&context->peak_bytes, &peak, live)) {
    }
    atomic_fetch_add(&context->live_blocks, 1);
}

void *starg_allocate(starg_context *context, size_t count, size_t size) {
    if (size != 0 && count > (PTRDIFF_MAX - sizeof(block_header)) / size)
        return NULL;
    size_t bytes = sizeof(block_header) + count * size;
    block_header *header = context->allocator.allocate(context->allocator.user, bytes);
    if (header == NULL)
        return NULL;
    header->of.bytes = bytes;
    header->of.context = context;
    count_up(context, bytes);
    return header + 1;
}

void *starg_allocate_zero(starg_context *context, size_t count, size_t size) {
    void *block = starg_allocate(context, count, size);
    if (block != NULL)
        memset(block, 0, count * size);
    return block;
}

void *starg_reallocate(starg_context *context, void *block, size_t count, size_t capacity,
                       size_t size) {
    void *grown = starg_allocate(context, capacity, size);
    if (grown == NULL)
        return NULL;
    if (block != NULL && count != 0)
        memcpy(grown, block, count * size);
    starg_release(context, block);
    return grown;
}

void *starg_shrink(starg_context *context, void *block, size_t size) {
    block_header *header = (block_header *)block - 1;
    const size_t before = header->of.bytes, bytes = sizeof *header + size;
    if (!context->resizes || bytes >= before)
        return block;
    block_header *smaller = realloc(header, bytes);
    if (smaller == NULL)
        return block;
    smaller->of.bytes = bytes;
    atomic_fetch_sub(&context->live_bytes, before - bytes);
    return smaller + 1;
}

void starg_release(starg_context *context, void *block) {
    if (block == NULL)
        return;
    block_header *header = (block_header *)block - 1;
    atomic_fetch_sub(&context->live_bytes, header->of.bytes);
    atomic_fetch_sub(&context->live_blocks, 1);
    context->allocator.release(context->allocator.user, header);
}

void starg_release_all(void *const *blocks, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (blocks[i] != NULL)
            starg_release(((block_header *)blocks[i] - 1)->of.context, blocks[i]);
}

void starg_release_scoped(void *pointer) {
    void *block;
    memcpy(&block, pointer, sizeof block);
    RELEASE(block);
}

void starg_text_free(starg_context *context, char *text) {
    (void)context;
    RELEASE(text);
}
