/* SPDX-License-Identifier: Apache-2.0 */
/* Memory from the context's allocator. Blocks store their size, so that the context knows what is
 * in use. Thread-safe. */
#ifndef STARG_CORE_MEMORY_H
#define STARG_CORE_MEMORY_H

#include <stddef.h>
#include <string.h>

#include "core/context.h"
#include "core/private.h"

/* count x size bytes, undefined (starg_allocate) or zero (starg_allocate_zero); NULL when out of
 * memory or on overflow. A count of 0 gives a valid block. */
void *starg_allocate(starg_context *context, size_t count, size_t size)
    STARG_PRIVATE(starg_allocate);
void *starg_allocate_zero(starg_context *context, size_t count, size_t size)
    STARG_PRIVATE(starg_allocate_zero);

/* Moves the first `count` elements of `block` (may be NULL) into a block of `capacity` elements and
 * frees the old one; returns NULL and leaves `block` alone when out of memory. */
void *starg_reallocate(starg_context *context, void *block, size_t count, size_t capacity,
                       size_t size) STARG_PRIVATE(starg_reallocate);

/* Frees a block; NULL is allowed. */
void starg_release(starg_context *context, void *block) STARG_PRIVATE(starg_release);

/* POINTER = COUNT elements of its type; jumps to `done` with STARG_ERROR_MEMORY on failure. */
#define STARG_NEW(CONTEXT, STAGE, POINTER, COUNT)                                                  \
    do {                                                                                           \
        (POINTER) = starg_allocate((CONTEXT), (COUNT), sizeof *(POINTER));                         \
        if ((POINTER) == NULL) {                                                                   \
            status = starg_fail_memory((CONTEXT), (STAGE));                                        \
            goto done;                                                                             \
        }                                                                                          \
    } while (0)

#define STARG_NEW_ZERO(CONTEXT, STAGE, POINTER, COUNT)                                             \
    do {                                                                                           \
        (POINTER) = starg_allocate_zero((CONTEXT), (COUNT), sizeof *(POINTER));                    \
        if ((POINTER) == NULL) {                                                                   \
            status = starg_fail_memory((CONTEXT), (STAGE));                                        \
            goto done;                                                                             \
        }                                                                                          \
    } while (0)

/* Growable array: struct { T *data; size_t count, capacity; }, all zero when empty. */
#define STARG_ARRAY(T)                                                                             \
    struct {                                                                                       \
        T *data;                                                                                   \
        size_t count, capacity;                                                                    \
    }

/* Appends VALUE; jumps to `done` with STARG_ERROR_MEMORY on failure. */
#define STARG_PUSH(CONTEXT, STAGE, ARRAY, VALUE)                                                   \
    do {                                                                                           \
        if ((ARRAY)->count == (ARRAY)->capacity) {                                                 \
            size_t starg_capacity_ = (ARRAY)->capacity ? 2 * (ARRAY)->capacity : 16;               \
            void *starg_data_ = starg_reallocate((CONTEXT), (ARRAY)->data, (ARRAY)->count,         \
                                                 starg_capacity_, sizeof *(ARRAY)->data);          \
            if (starg_data_ == NULL) {                                                             \
                status = starg_fail_memory((CONTEXT), (STAGE));                                    \
                goto done;                                                                         \
            }                                                                                      \
            (ARRAY)->data = starg_data_;                                                           \
            (ARRAY)->capacity = starg_capacity_;                                                   \
        }                                                                                          \
        (ARRAY)->data[(ARRAY)->count++] = (VALUE);                                                 \
    } while (0)

#define STARG_ARRAY_FREE(CONTEXT, ARRAY) starg_release((CONTEXT), (ARRAY)->data)

#endif
