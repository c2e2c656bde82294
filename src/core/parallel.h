/* SPDX-License-Identifier: Apache-2.0 */
/* Parallel loops whose result does not depend on the number of threads: an item writes only to
 * outputs addressed by its index. */
#pragma once

#include "core/ranks.h"

/* Computes one item. `scratch` belongs to the running thread. It may allocate, but not log, report
 * progress or set error detail (the calling thread does). */
typedef starg_status starg_parallel_item(starg_context *context, void *shared, void *scratch,
                                         size_t item);

/* How other processes compute items of a loop (core/distribute.c). */
typedef struct starg_parallel_remote {
    ranks_work_kind work;
    const starg_bytes *job; /* data common to all items */
    size_t most;            /* items per block; 0: proportional to what is left */
    /* Stores a helper's results for these items, on the calling thread. */
    starg_status (*take)(starg_context *context, void *shared, size_t first, size_t count,
                         starg_bytes_reader *reply);
} starg_parallel_remote;

typedef struct starg_parallel_loop {
    const char *stage; /* static; name in progress and errors */
    size_t count;
    void *shared;
    starg_parallel_item *item;
    /* Scratch memory per thread; both may be NULL. make sets *scratch or fails. */
    starg_status (*make_scratch)(starg_context *context, void *shared, void **scratch);
    void (*free_scratch)(starg_context *context, void *scratch);
    double share; /* part of the enclosing stage, for progress */
    bool silent;  /* one of many short loops, whose caller reports progress */
    /* Called on the calling thread from time to time and at the end, when all items below
     * `finished` are done. May set error detail. May be NULL. */
    starg_status (*advance)(starg_context *context, void *shared, size_t finished);
    const starg_parallel_remote *remote; /* used if the context has helpers; NULL: not shared */
} starg_parallel_loop;

/* Runs the items 0 to count - 1 on up to the context's threads, including the calling one. On
 * failure returns the status of the lowest failed item, or CANCELLED; some items have then not
 * run. */
starg_status starg_parallel_for(starg_context *context, const starg_parallel_loop *loop)
    STARG_PRIVATE(starg_parallel_for);

/* Same, but fails with STARG_ERROR_TIME at the time limit. */
starg_status starg_parallel_in_time(starg_context *context, const starg_parallel_loop *loop)
    STARG_PRIVATE(starg_parallel_in_time);
