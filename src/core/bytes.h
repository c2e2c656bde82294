/* SPDX-License-Identifier: Apache-2.0 */
/* Messages as bytes: values are read in the order in which they were written. Numbers keep their
 * layout in memory, since both ends are the same program. */
#ifndef STARG_CORE_BYTES_H
#define STARG_CORE_BYTES_H

#include <stdint.h>

#include "core/memory.h"
#include "core/private.h"

typedef STARG_ARRAY(uint8_t) starg_bytes;

/* Appends `count` elements of `size` bytes; `data` may be NULL when count is 0. Errors: MEMORY,
 * also when the size overflows. */
starg_status starg_bytes_put(starg_context *context, starg_bytes *bytes, const void *data,
                             size_t count, size_t size) STARG_PRIVATE(starg_bytes_put);

typedef struct starg_bytes_reader {
    const uint8_t *next;
    size_t left;
} starg_bytes_reader;

/* Copies the next `count` elements; returns false and reads nothing when fewer are left. */
bool starg_bytes_take(starg_bytes_reader *reader, void *data, size_t count, size_t size)
    STARG_PRIVATE(starg_bytes_take);

/* Copies them into a new block of the context, followed by one zero byte so that texts are
 * terminated. Errors: MEMORY, RANK (too few bytes left). */
starg_status starg_bytes_take_block(starg_context *context, starg_bytes_reader *reader,
                                    size_t count, size_t size, void **out)
    STARG_PRIVATE(starg_bytes_take_block);

#endif
