/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that run loops, and the one loop that they run. */
#pragma once

#include <threads.h>

#include "core/parallel.h"

/* ---- threads of a context besides the calling one (workers.c) ---- */
/* They sleep between loops: searches run many loops that take less time than the start of a
 * thread. Items of a loop may run loops of their own, which threads without an item join. */

/* Calls of run(argument) by other threads. */
typedef struct workers_task {
    void (*run)(void *argument);
    void *argument;
    size_t wanted;  /* calls that have not begun; at first the most that make sense */
    size_t running; /* at first 0 */
    struct workers_task *former;
} workers_task;

/* Lets other threads make the calls that are wanted, until workers_end; fewer if they have other
 * work or cannot be started. False, with nothing to end: no memory. */
bool workers_begin(starg_context *context, workers_task *task);

/* Waits for the calls that have begun; no other begins. */
void workers_end(starg_context *context, workers_task *task);

/* Ends the threads. */
void workers_free(starg_context *context);

/* ---- what the threads of a parallel loop share (parallel.c) ---- */

typedef struct worker_group {
    starg_context *context;
    const starg_parallel_loop *loop;
    starg_time_rule rule; /* of the calling thread */
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
