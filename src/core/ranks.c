/* SPDX-License-Identifier: Apache-2.0 */
#include "core/parallel.h"

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

void starg_context_set_ranks(starg_context *context, const starg_ranks *ranks) {
    context->ranks = ranks != NULL && ranks->count > 1 && ranks->rank == 0 ? ranks : NULL;
}

double starg_context_shared_seconds(const starg_context *context) {
    return context->shared_seconds;
}

uint64_t starg_context_helped_items(const starg_context *context) {
    return context->helped_items;
}

static starg_status fail_lost(starg_context *context) {
    return starg_fail(context, STARG_ERROR_RANK, STAGE,
                      "the connection to another process of this run is broken");
}

starg_status ranks_send(starg_context *context, const starg_ranks *ranks, int to,
                        const ranks_message *head, const void *rest, size_t size) {
    SCOPED starg_bytes message = {0};
    TRY(starg_bytes_put(context, &message, head, 1, sizeof *head));
    TRY(starg_bytes_put(context, &message, rest, size, 1));
    if (!ranks->send(ranks->user, to, message.data, message.count))
        return fail_lost(context);
    return STARG_OK;
}

starg_status ranks_receive(starg_context *context, const starg_ranks *ranks, double seconds,
                           int *from, ranks_message *head, starg_bytes_reader *rest, void **bytes) {
    starg_status status = STARG_OK;
    uint8_t *block = NULL;
    size_t size;
    *bytes = NULL;
    if (!ranks->wait(ranks->user, seconds, from, &size))
        return fail_lost(context);
    if (*from < 0)
        return STARG_OK;
    STARG_NEW(context, STAGE, block, size);
    *rest = (starg_bytes_reader){block, size};
    if (*from >= ranks->count || !ranks->receive(ranks->user, *from, block, size) ||
        !starg_bytes_take(rest, head, 1, sizeof *head)) {
        status = fail_lost(context);
        goto done;
    }
    *bytes = block;
done:
    if (status != STARG_OK)
        starg_release(context, block);
    return status;
}

/* Receives whatever else the helper sent, so that it does not block on sending. */
starg_status starg_ranks_release(starg_context *context, const starg_ranks *ranks) {
    const ranks_message end = {.kind = RANKS_END};
    for (int to = 1; to < ranks->count; to++)
        TRY(ranks_send(context, ranks, to, &end, NULL, 0));
    for (int gone = 1; gone < ranks->count;) {
        void *bytes;
        int from;
        ranks_message head;
        starg_bytes_reader rest;
        TRY(ranks_receive(context, ranks, 1, &from, &head, &rest, &bytes));
        gone += bytes != NULL && head.kind == RANKS_END;
        starg_release(context, bytes);
    }
    return STARG_OK;
}
