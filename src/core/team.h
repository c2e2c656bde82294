/* Inside of parallel loops: what those who work on one share. */
#ifndef STARG_CORE_TEAM_H
#define STARG_CORE_TEAM_H

#include <threads.h>

#include "core/parallel.h"

typedef struct team {
    starg_context *context;
    const starg_parallel_loop *loop;
    atomic_size_t next, finished;
    atomic_bool stop;
    atomic_uchar *is_finished; /* by item; NULL unless somebody wants to know */
    size_t advanced;           /* items that `advance` has been told of       */
    mtx_t lock;                /* guards the two below                        */
    size_t failed_item;
    starg_status failed_status;
    starg_status calling_status; /* failure of the calling thread's own, with its detail set */
} team;

void team_fail(team *crew, size_t item, starg_status status);

/* Is it in vain to begin with the item? Notes why. */
bool team_must_stop(team *crew, size_t item);

/* Counts items as finished. */
void team_finish(team *crew, size_t first, size_t count);

/* What the calling thread does between items: tells how far the loop is. */
void team_report(team *crew);

/* The calling thread's part in a loop that is shared with other processes (core/share.c). */
void team_share(team *crew);

#endif
