/* SPDX-License-Identifier: Apache-2.0 */
/* Parallel loops whose result does not depend on the number of threads: each item writes only to
 * outputs of its own index. */
#ifndef STARG_CORE_PARALLEL_H
#define STARG_CORE_PARALLEL_H

#include "core/private.h"
#include "core/ranks.h"

/* Works on one item. `scratch` belongs to the running thread. Allocation is allowed; logging,
 * progress and error detail are not (the calling thread does that). */
typedef starg_status starg_parallel_item(starg_context *context, void *shared, void *scratch,
                                         size_t item);

/* How other processes work on items of a loop (core/distribute.c). */
typedef struct starg_parallel_remote {
    ranks_work_kind work;
    const starg_bytes *job; /* what they have to know of all items                         */
    size_t most;            /* items that they get at once; 0: the more, the more are left */
    /* Takes what a helper appended to its reply for these items, on the calling thread. */
    starg_status (*take)(starg_context *context, void *shared, size_t first, size_t count,
                         starg_bytes_reader *reply);
} starg_parallel_remote;

typedef struct starg_parallel_loop {
    const char *stage; /* static; named in progress and errors */
    size_t count;
    void *shared;
    starg_parallel_item *item;
    /* Scratch memory of each thread; both may be NULL. make sets *scratch or fails. */
    starg_status (*make_scratch)(starg_context *context, void *shared, void **scratch);
    void (*free_scratch)(starg_context *context, void *scratch);
    double share; /* of the stage around it, for its progress                             */
    bool silent;  /* one of many short loops: the caller reports the progress of them all */
    /* Called on the calling thread, now and then and at the end, when the items below `finished`
     * are. It may set error detail. NULL: not wanted. */
    starg_status (*advance)(starg_context *context, void *shared, size_t finished);
    const starg_parallel_remote *remote; /* used where the context has helpers; NULL: not shared */
} starg_parallel_loop;

/* Runs the items 0 to count - 1 on up to the context's threads, the calling one among them.
 * Fails with the status of the lowest item that failed, or when cancelled; then some items have
 * not been run. */
starg_status starg_parallel_for(starg_context *context, const starg_parallel_loop *loop)
    STARG_PRIVATE(starg_parallel_for);

/* The same, and gives up with STARG_ERROR_TIME when the time limit passes. */
starg_status starg_parallel_in_time(starg_context *context, const starg_parallel_loop *loop)
    STARG_PRIVATE(starg_parallel_in_time);

#endif
