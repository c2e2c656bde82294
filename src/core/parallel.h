/* SPDX-License-Identifier: Apache-2.0 */
/* Parallel loops, on threads and in other processes. */
#pragma once

#include "core/memory.h"

/* ---- messages between rank 0 and its helpers (ranks.c, serve.c, distribute.c) ---- */
/* For each shared loop rank 0 sends every helper a JOB (the data common to all items), then BLOCKs:
 * ranges of items. A helper answers each block with one REPLY, in order. END releases a helper,
 * which echoes it. Loops are numbered, so that late replies can be recognized. Public:
 * starguard/ranks.h. */

/* ---- messages as bytes (ranks.c) ---- */
/* Values are read in the order in which they were written. Numbers keep their layout in memory,
 * since both ends are the same program. */

typedef STARG_ARRAY(uint8_t) starg_bytes;

/* Appends `count` elements of `size` bytes; `data` may be NULL when count is 0. Errors: MEMORY,
 * also when the size overflows. */
starg_status starg_bytes_put(starg_context *context, starg_bytes *bytes, const void *data,
                             size_t count, size_t size) STARG_PRIVATE(starg_bytes_put);

typedef struct starg_bytes_reader {
    const uint8_t *next;
    size_t left;
} starg_bytes_reader;

/* Copies the next `count` elements; returns false and reads nothing when fewer are left. */
bool starg_bytes_take(starg_bytes_reader *reader, void *data, size_t count, size_t size)
    STARG_PRIVATE(starg_bytes_take);

/* Copies them into a new block of the context, followed by one zero byte so that texts are
 * terminated. Errors: MEMORY, RANK (too few bytes left). */
starg_status starg_bytes_take_block(starg_context *context, starg_bytes_reader *reader,
                                    size_t count, size_t size, void **out)
    STARG_PRIVATE(starg_bytes_take_block);

typedef enum ranks_message_kind {
    RANKS_JOB = 1,
    RANKS_BLOCK = 2,
    RANKS_REPLY = 3,
    RANKS_END = 4
} ranks_message_kind;

/* The function of a helper that does a job. */
typedef enum ranks_work_kind {
    RANKS_VISIBILITY = 0,
    RANKS_DESCRIBE = 1,
    RANKS_CELLS = 2,
    RANKS_WORKS = 3
} ranks_work_kind;

/* Head of a message; the payload belongs to the work. */
typedef struct ranks_message {
    uint64_t loop, seed;   /* seed: JOB */
    uint64_t first, count; /* BLOCK, REPLY: items */
    double seconds;        /* JOB: time left; 0 or less: no limit */
    uint32_t kind, work;   /* a ranks_message_kind; JOB: a ranks_work_kind */
    int32_t status;        /* REPLY: a starg_status */
    uint32_t unused;
} ranks_message;

/* One kind of work, on the helper. */
typedef struct ranks_work {
    /* Reads a job. *state is that of the last job of this kind, NULL at first, and is replaced or
     * used again; `end` frees it and accepts NULL. */
    starg_status (*begin)(starg_context *context, starg_bytes_reader *job, void **state);
    /* Computes items and appends their results. With STARG_ERROR_TIME it may append the items that
     * are finished. */
    starg_status (*run)(starg_context *context, void *state, size_t first, size_t count,
                        starg_bytes *reply);
    void (*end)(starg_context *context, void *state);
} ranks_work;

/* Sends a head and its payload. Errors: MEMORY, RANK. */
starg_status ranks_send(starg_context *context, const starg_ranks *ranks, int to,
                        const ranks_message *head, const void *rest, size_t size);

/* Waits up to so many seconds for a message. *bytes is a block of the context, NULL if none came;
 * *rest is the payload. Errors: MEMORY, RANK. */
starg_status ranks_receive(starg_context *context, const starg_ranks *ranks, double seconds,
                           int *from, ranks_message *head, starg_bytes_reader *rest, void **bytes);

/* Serves rank 0 until it sends END. `works` lists this process's kinds of work by ranks_work_kind,
 * NULL for those that it lacks. Errors: as for starg_ranks_serve. */
starg_status ranks_serve(starg_context *context, const starg_ranks *ranks,
                         const ranks_work *const works[RANKS_WORKS]) STARG_PRIVATE(ranks_serve);

/* ---- loops whose result does not depend on the number of threads (parallel.c) ---- */
/* An item writes only to outputs addressed by its index. */

/* Computes one item. `scratch` belongs to the running thread. It may allocate, have a time rule,
 * and run loops, which threads that have no item help with. It may not log or set error detail, but
 * for the first item, which the calling thread runs; progress of other threads is not reported. */
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

/* ---- a few different tasks (parallel.c) ---- */

enum { STARG_TASKS_MOST = 4 };

/* Tasks 0 to count - 1, of which none needs another. */
typedef struct starg_tasks {
    const char *stage;
    size_t count;
    void *shared;
    starg_status (*run)(starg_context *context, void *shared, size_t task);
    void (*undo)(void *shared, size_t task); /* frees what a task has made, if anything */
} starg_tasks;

/* Runs them side by side. If one fails, other than for memory, they are undone and run one after
 * the other, so that status and error detail are those of the first that fails. */
starg_status starg_run_tasks(starg_context *context, const starg_tasks *tasks)
    STARG_PRIVATE(starg_run_tasks);
