/* SPDX-License-Identifier: Apache-2.0 */
#include "core/ranks.h"

static const char STAGE[] = "ranks";

starg_status starg_bytes_put(starg_context *context, starg_bytes *bytes, const void *data,
                             size_t count, size_t size) {
    if (size != 0 && count > (PTRDIFF_MAX / 2 - bytes->count) / size)
        return starg_fail_memory(context, STAGE);
    size_t more = count * size;
    if (bytes->capacity - bytes->count < more) {
        size_t capacity = bytes->count + more + bytes->count / 2;
        uint8_t *grown = starg_reallocate(context, bytes->data, bytes->count, capacity, 1);
        if (grown == NULL)
            return starg_fail_memory(context, STAGE);
        bytes->data = grown;
        bytes->capacity = capacity;
    }
    if (more > 0)
        memcpy(bytes->data + bytes->count, data, more);
    bytes->count += more;
    return STARG_OK;
}

bool starg_bytes_take(starg_bytes_reader *reader, void *data, size_t count, size_t size) {
    if (size != 0 && count > reader->left / size)
        return false;
    if (count * size > 0)
        memcpy(data, reader->next, count * size);
    reader->next += count * size;
    reader->left -= count * size;
    return true;
}

starg_status starg_bytes_take_block(starg_context *context, starg_bytes_reader *reader,
                                    size_t count, size_t size, void **out) {
    *out = NULL;
    if (size != 0 && count > reader->left / size)
        return starg_fail(context, STARG_ERROR_RANK, STAGE,
                          "truncated message from another process");
    uint8_t *block = starg_allocate(context, count * size + 1, 1);
    if (block == NULL)
        return starg_fail_memory(context, STAGE);
    starg_bytes_take(reader, block, count, size);
    block[count * size] = 0;
    *out = block;
    return STARG_OK;
}
