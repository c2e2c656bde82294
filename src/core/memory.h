/* SPDX-License-Identifier: Apache-2.0 */
/* Memory from the context's allocator. Blocks store their size, so that the context knows what is
 * in use. Thread-safe. */
#pragma once

#include <string.h>

#include "core/context.h"

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

/* Gives the end of a block back, beyond `size` bytes, where the allocator is malloc; otherwise the
 * block stays as it is. Returns the block, which may have moved. */
void *starg_shrink(starg_context *context, void *block, size_t size) STARG_PRIVATE(starg_shrink);

/* Frees a block; NULL is allowed. */
void starg_release(starg_context *context, void *block) STARG_PRIVATE(starg_release);

/* Frees blocks, which know their contexts; NULL is allowed. */
#define RELEASE(...)                                                                               \
    starg_release_all((void *const[]){__VA_ARGS__},                                                \
                      sizeof((void *const[]){__VA_ARGS__}) / sizeof(void *))
void starg_release_all(void *const *blocks, size_t count) STARG_PRIVATE(starg_release_all);

/* ---- Functions that return at once on failure ----
 *
 * What a function holds only while it runs belongs to its scope: SCOPED before the declaration of a
 * block, or of a STARG_ARRAY, releases it on every way out, and SCOPED_BY(f) hands the variable's
 * address to f. A result leaves its scope by setting the variable to NULL. */
void starg_release_scoped(void *pointer) STARG_PRIVATE(starg_release_scoped);
#define SCOPED       SCOPED_BY(starg_release_scoped)
#define SCOPED_BY(F) __attribute__((cleanup(F)))

/* A stage of progress, or a rule of time, until the scope ends. */
#define IN_STAGE(CONTEXT, NAME) IN_STAGE_PART(CONTEXT, NAME, 0)
#define IN_STAGE_PART(CONTEXT, NAME, SHARE)                                                        \
    SCOPED_BY(starg_stage_leave)                                                                   \
    starg_context *starg_stage_ = starg_stage_enter((CONTEXT), (NAME), (SHARE))
starg_context *starg_stage_enter(starg_context *context, const char *stage, double share)
    STARG_PRIVATE(starg_stage_enter);
void starg_stage_leave(starg_context **context) STARG_PRIVATE(starg_stage_leave);

typedef struct starg_time_scope {
    starg_context *context;
    starg_time_rule former;
} starg_time_scope;

#define TIME_RULE(CONTEXT, RULE)                                                                   \
    SCOPED_BY(starg_time_leave)                                                                    \
    starg_time_scope starg_time_ = {(CONTEXT), starg_time_begin((CONTEXT), (RULE))}
static inline void starg_time_leave(starg_time_scope *scope) {
    starg_time_end(scope->context, scope->former);
}

/* Defines NAME_drop for SCOPED_BY, where NAME_free takes a pointer. */
#define STARG_DROP(NAME, TYPE)                                                                     \
    static inline void NAME##_drop(TYPE **object) {                                                \
        NAME##_free(*object);                                                                      \
    }

/* The same for results, whose public TYPE_free has a context that it does not need. */
#define STARG_DROP_RESULT(TYPE)                                                                    \
    static inline void TYPE##_drop(TYPE **object) {                                                \
        TYPE##_free(NULL, *object);                                                                \
    }

/* Evaluates EXPR; returns its status on failure. */
#define TRY(EXPR)                                                                                  \
    do {                                                                                           \
        starg_status starg_status_ = (EXPR);                                                       \
        if (starg_status_ != STARG_OK)                                                             \
            return starg_status_;                                                                  \
    } while (0)

/* POINTER = COUNT elements of its type; returns STARG_ERROR_MEMORY on failure. */
#define NEW(CONTEXT, STAGE, POINTER, COUNT)                                                        \
    do {                                                                                           \
        (POINTER) = starg_allocate((CONTEXT), (COUNT), sizeof *(POINTER));                         \
        if ((POINTER) == NULL)                                                                     \
            return starg_fail_memory((CONTEXT), (STAGE));                                          \
    } while (0)

#define NEW_ZERO(CONTEXT, STAGE, POINTER, COUNT)                                                   \
    do {                                                                                           \
        (POINTER) = starg_allocate_zero((CONTEXT), (COUNT), sizeof *(POINTER));                    \
        if ((POINTER) == NULL)                                                                     \
            return starg_fail_memory((CONTEXT), (STAGE));                                          \
    } while (0)

/* ---- The same, for functions that clean up after `done` ---- */

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

/* Gives an array so much room, at least for what it holds; returns STARG_ERROR_MEMORY on failure.
 */
#define RESERVE(CONTEXT, STAGE, ARRAY, CAPACITY)                                                   \
    do {                                                                                           \
        size_t starg_room_ = (CAPACITY);                                                           \
        if ((ARRAY)->capacity != starg_room_) {                                                    \
            void *starg_data_ = starg_reallocate((CONTEXT), (ARRAY)->data, (ARRAY)->count,         \
                                                 starg_room_, sizeof *(ARRAY)->data);              \
            if (starg_data_ == NULL)                                                               \
                return starg_fail_memory((CONTEXT), (STAGE));                                      \
            (ARRAY)->data = starg_data_;                                                           \
            (ARRAY)->capacity = starg_room_;                                                       \
        }                                                                                          \
    } while (0)

/* Appends VALUE; returns STARG_ERROR_MEMORY on failure. */
#define PUSH(CONTEXT, STAGE, ARRAY, VALUE)                                                         \
    do {                                                                                           \
        if ((ARRAY)->count == (ARRAY)->capacity) {                                                 \
            size_t starg_capacity_ = (ARRAY)->capacity ? 2 * (ARRAY)->capacity : 16;               \
            void *starg_data_ = starg_reallocate((CONTEXT), (ARRAY)->data, (ARRAY)->count,         \
                                                 starg_capacity_, sizeof *(ARRAY)->data);          \
            if (starg_data_ == NULL)                                                               \
                return starg_fail_memory((CONTEXT), (STAGE));                                      \
            (ARRAY)->data = starg_data_;                                                           \
            (ARRAY)->capacity = starg_capacity_;                                                   \
        }                                                                                          \
        (ARRAY)->data[(ARRAY)->count++] = (VALUE);                                                 \
    } while (0)

/* The same; jumps to `done`. */
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
