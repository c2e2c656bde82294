/* SPDX-License-Identifier: Apache-2.0 */
/* Memory from the context's allocator. Blocks remember their size, so that the context can tell
 * what is in use. All of it may be called from worker threads. */
#ifndef STARG_CORE_MEMORY_H
#define STARG_CORE_MEMORY_H

#include <stddef.h>
#include <string.h>

#include "core/context.h"
#include "core/private.h"

/* count x size bytes, or NULL when memory is out or the product does not fit. A count of 0 gives
 * a valid block. The contents are undefined (allocate) or zero (allocate_zero). */
void *starg_allocate(starg_context *context, size_t count, size_t size)
    STARG_PRIVATE(starg_allocate);
void *starg_allocate_zero(starg_context *context, size_t count, size_t size)
    STARG_PRIVATE(starg_allocate_zero);

/* A block of `capacity` x size bytes that starts with the `count` elements of `block`, which is
 * freed; NULL (and `block` untouched) when memory is out. `block` may be NULL. */
void *starg_reallocate(starg_context *context, void *block, size_t count, size_t capacity,
                       size_t size) STARG_PRIVATE(starg_reallocate);

/* Frees a block; NULL is fine. */
void starg_release(starg_context *context, void *block) STARG_PRIVATE(starg_release);

/* POINTER = count elements of its own type, or leave by `done` with STARG_ERROR_MEMORY. */
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

/* Growable arrays: a struct { T *data; size_t count, capacity; }, all zero when empty. */
#define STARG_ARRAY(T)                                                                             \
    struct {                                                                                       \
        T *data;                                                                                   \
        size_t count, capacity;                                                                    \
    }

/* Appends VALUE, or leaves by `done` with STARG_ERROR_MEMORY. */
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
