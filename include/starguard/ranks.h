/* SPDX-License-Identifier: Apache-2.0 */
/* Several processes that share the work of one, for machines that have no memory in common. The
 * first of them, rank 0, makes the calls of this library; the others, its helpers, wait in
 * starg_ranks_serve for what it hands out: visibility rows, and files to be described. How bytes go
 * from one to the other is the caller's: the command line does it by MPI. All processes have to be
 * of the same program on machines of the same kind. Results do not depend on the number of helpers.
 */
#ifndef STARGUARD_RANKS_H
#define STARGUARD_RANKS_H

#include <stdbool.h>
#include <stddef.h>

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The way to the other processes. Messages go between rank 0 and its helpers, never between
 * helpers, and those from one process to another arrive whole and in their order. All functions are
 * called on the thread that makes the call of this library; they return false when the way is
 * broken. */
typedef struct starg_ranks {
    int rank, count; /* of this process; of all of them */
    /* Sends a message; it may wait until the other process takes it. */
    bool (*send)(void *user, int to, const void *bytes, size_t size);
    /* Waits for a message for at most so many seconds: who sent it (-1: none came), and its size.
     */
    bool (*wait)(void *user, double seconds, int *from, size_t *size);
    /* Takes the message that `wait` has told of. */
    bool (*receive)(void *user, int from, void *bytes, size_t size);
    void *user;
} starg_ranks;

/* Makes the calls on a context share their work from now on, on rank 0; NULL: no more. `ranks` has
 * to outlive the context. */
STARG_API void starg_context_set_ranks(starg_context *context, const starg_ranks *ranks);

/* Seconds that calls on the context have spent in work that is shared, and how much of it others
 * have done: visibility rows and files. */
STARG_API double starg_context_shared_seconds(const starg_context *context);
STARG_API uint64_t starg_context_helped_items(const starg_context *context);

/* Computes the visibility rows that rank 0 hands out until it is released, on a helper. The context
 * gives memory and threads. Errors: RANK (the way is broken), MEMORY (for a message), CANCELLED.
 * What fails in the work itself is told to rank 0, whose call fails with it. */
STARG_API starg_status starg_ranks_serve(starg_context *context, const starg_ranks *ranks);

/* Sends all helpers home and waits until they go, on rank 0; the context gives memory. Not after a
 * cancellation: then they may be at work for long. Errors: RANK, MEMORY. */
STARG_API starg_status starg_ranks_release(starg_context *context, const starg_ranks *ranks);

#ifdef __cplusplus
}
#endif

#endif
