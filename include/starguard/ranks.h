/* SPDX-License-Identifier: Apache-2.0 */
/* Distributes work among several processes without shared memory. Rank 0 calls the library; the
 * other ranks, its helpers, wait in starg_ranks_serve for visibility rows, boxes and files to
 * process. The caller provides the transport: the command line uses MPI. All processes must run the
 * same program on machines of the same kind. Results do not depend on the number of helpers. */
#ifndef STARGUARD_RANKS_H
#define STARGUARD_RANKS_H

#include <stdbool.h>
#include <stddef.h>

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The transport. Messages go between rank 0 and its helpers, never between helpers; messages
 * between two processes arrive complete and in order. All functions are called on the calling
 * thread; they return false when the connection is broken. */
typedef struct starg_ranks {
    int rank, count; /* of this process; number of processes */
    /* Sends a message; may wait until the other process receives it. */
    bool (*send)(void *user, int to, const void *bytes, size_t size);
    /* Waits for a message for at most `seconds`; returns its sender (-1: none) and size. */
    bool (*wait)(void *user, double seconds, int *from, size_t *size);
    /* Receives the message reported by `wait`. */
    bool (*receive)(void *user, int from, void *bytes, size_t size);
    void *user;
} starg_ranks;

/* Distributes the work of all following calls on a context, on rank 0; NULL: none. `ranks` must
 * outlive the context. */
STARG_API void starg_context_set_ranks(starg_context *context, const starg_ranks *ranks);

/* Seconds spent in distributed work by calls on the context, and the number of items (visibility
 * rows and files) that helpers processed. */
STARG_API double starg_context_shared_seconds(const starg_context *context);
STARG_API uint64_t starg_context_helped_items(const starg_context *context);

/* Processes visibility rows and boxes for rank 0 until released, on a helper. The context provides
 * memory and threads. Errors: RANK (connection broken), MEMORY (for a message), CANCELLED. Failures
 * of the work itself are reported by rank 0's call. */
STARG_API starg_status starg_ranks_serve(starg_context *context, const starg_ranks *ranks);

/* Releases all helpers and waits until they end, on rank 0; the context provides memory. Do not
 * call after a cancellation, when helpers may still be busy. Errors: RANK, MEMORY. */
STARG_API starg_status starg_ranks_release(starg_context *context, const starg_ranks *ranks);

#ifdef __cplusplus
}
#endif

#endif
