/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that run loops, and the one loop that they run. */
#pragma once

#include <threads.h>

#include "core/parallel.h"

/* ---- threads of a context besides the calling one (workers.c) ---- */
/* They sleep between loops: searches run many loops that take less time than the start of a
 * thread. */

/* Lets up to `most` threads call run(argument), each once, until workers_end; fewer if they cannot
 * be started. *begun is false if the threads are in use already: nothing is to be ended then.
 * Errors: MEMORY, without detail. */
starg_status workers_begin(starg_context *context, size_t most, void (*run)(void *argument),
                           void *argument, bool *begun);

/* Waits for the calls that have begun; no other begins. */
void workers_end(starg_context *context);

/* Ends the threads. */
void workers_free(starg_context *context);

/* ---- what the threads of a parallel loop share (parallel.c) ---- */

typedef struct worker_group {
    starg_context *context;
    const starg_parallel_loop *loop;
    atomic_size_t next, finished;
    atomic_bool stop;
    atomic_uchar *is_finished; /* by item; NULL if unused */
    size_t advanced;           /* items reported to `advance` */
    mtx_t lock;                /* guards the two below */
    size_t failed_item;
    starg_status failed_status;
    starg_status calling_status; /* failure of the calling thread itself, with detail set */
} worker_group;

void worker_group_fail(worker_group *group, size_t item, starg_status status);

/* True if the item should not be started; records the reason. */
bool worker_group_must_stop(worker_group *group, size_t item);

/* Counts items as finished. */
void worker_group_finish(worker_group *group, size_t first, size_t count);

/* Reports progress of the loop, on the calling thread between items. */
void worker_group_report(worker_group *group);

/* The calling thread's part in a loop that is shared with other processes (core/distribute.c). */
void worker_group_distribute(worker_group *group);
