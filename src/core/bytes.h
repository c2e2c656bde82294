/* SPDX-License-Identifier: Apache-2.0 */
/* Messages as bytes: what is put into a buffer in order is taken out in the same order. Numbers
 * keep the form that they have in memory: both ends are the same program. */
#ifndef STARG_CORE_BYTES_H
#define STARG_CORE_BYTES_H

#include <stdint.h>

#include "core/memory.h"
#include "core/private.h"

typedef STARG_ARRAY(uint8_t) starg_bytes;

/* Appends `count` elements of `size` bytes; `data` may be NULL where there are none. Errors:
 * MEMORY, also when the size does not fit. */
starg_status starg_bytes_put(starg_context *context, starg_bytes *bytes, const void *data,
                             size_t count, size_t size) STARG_PRIVATE(starg_bytes_put);

typedef struct starg_bytes_reader {
    const uint8_t *next;
    size_t left;
} starg_bytes_reader;

/* The next `count` elements are copied; false, and nothing done, where there are fewer. */
bool starg_bytes_take(starg_bytes_reader *reader, void *data, size_t count, size_t size)
    STARG_PRIVATE(starg_bytes_take);

/* The same into a block of the context's, with one zero byte behind it, as texts need it. Errors:
 * MEMORY, RANK (there are fewer). */
starg_status starg_bytes_take_block(starg_context *context, starg_bytes_reader *reader,
                                    size_t count, size_t size, void **out)
    STARG_PRIVATE(starg_bytes_take_block);

#endif
