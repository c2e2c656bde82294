/* SPDX-License-Identifier: Apache-2.0 */
/* What rank 0 and its helpers say to each other (starguard/ranks.h).
 *
 * For each shared loop rank 0 sends every helper a JOB, all that the loop's items have in common,
 * and then BLOCKs: ranges of items. A helper answers each block with one REPLY, in their order. END
 * sends it home, and is sent back. Loops are numbered, so that a reply that nobody waits for any
 * more is known by its loop. */
#ifndef STARG_CORE_RANKS_H
#define STARG_CORE_RANKS_H

#include "core/bytes.h"
#include "core/private.h"

typedef enum ranks_message_kind {
    RANKS_JOB = 1,
    RANKS_BLOCK = 2,
    RANKS_REPLY = 3,
    RANKS_END = 4
} ranks_message_kind;

/* Which function of a helper a job is for. */
typedef enum ranks_work_kind {
    RANKS_VISIBILITY = 0,
    RANKS_DESCRIBE = 1,
    RANKS_WORKS = 2
} ranks_work_kind;

/* The head of a message; what follows it is the work's own. */
typedef struct ranks_message {
    uint64_t loop, seed;   /* seed: JOB                                            */
    uint64_t first, count; /* BLOCK, REPLY: items                                  */
    double seconds;        /* JOB: that the time limit leaves; 0 or less: no limit */
    uint32_t kind, work;   /* a ranks_message_kind; JOB: a ranks_work_kind         */
    int32_t status;        /* REPLY: a starg_status                                */
    uint32_t unused;
} ranks_message;

/* One kind of work on the helpers' side. */
typedef struct ranks_work {
    /* What a job brings; *state is freed by `end`, which takes NULL. */
    starg_status (*begin)(starg_context *context, starg_bytes_reader *job, void **state);
    /* Works on items and appends what becomes of them. With STARG_ERROR_TIME what was finished may
     * be appended as well. */
    starg_status (*run)(starg_context *context, void *state, size_t first, size_t count,
                        starg_bytes *reply);
    void (*end)(starg_context *context, void *state);
} ranks_work;

/* Sends a head and what follows it. Errors: MEMORY, RANK. */
starg_status ranks_send(starg_context *context, const starg_ranks *ranks, int to,
                        const ranks_message *head, const void *rest, size_t size);

/* Waits for a message for at most so many seconds. *bytes is a block of the context's, NULL if none
 * came; *rest is what follows its head. Errors: MEMORY, RANK. */
starg_status ranks_receive(starg_context *context, const starg_ranks *ranks, double seconds,
                           int *from, ranks_message *head, starg_bytes_reader *rest, void **bytes);

/* Does what rank 0 hands out until it is released; `works` has the kinds that this process can do,
 * by ranks_work_kind, NULL for others. Errors: as of starg_ranks_serve. */
starg_status ranks_serve(starg_context *context, const starg_ranks *ranks,
                         const ranks_work *const works[RANKS_WORKS]) STARG_PRIVATE(ranks_serve);

#endif
