/* Inside of the context: memory, error detail, cancellation, deadline. */
#ifndef STARG_CORE_CONTEXT_H
#define STARG_CORE_CONTEXT_H

#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/private.h"
#include "starguard/context.h"
#include "starguard/ranks.h"

struct starg_context {
    starg_allocator allocator;
    int threads;
    uint64_t seed;
    starg_log_fn *log;
    void *log_user;
    starg_progress_fn *progress;
    void *progress_user;

    atomic_bool cancelled;
    double deadline;     /* of starg_clock(); 0: none */
    unsigned unfinished; /* calls under way that have nothing to show until they are done */

    const starg_ranks *ranks; /* whom the work is shared with, or NULL */
    uint64_t shared_loops;    /* so far: the number of the last one    */
    double shared_seconds;    /* spent in them                         */
    uint64_t helped_items;    /* of them, that others have worked on   */

    atomic_size_t live_bytes, peak_bytes, live_blocks;

    const char *progress_stage;
    double progress_next; /* clock at which the callback is due again */

    starg_error error;
    char message[512];
};

/* Runs EXPR and leaves by the label `done` when it fails; the function has a `status`. */
#define STARG_TRY(EXPR)                                                                            \
    do {                                                                                           \
        status = (EXPR);                                                                           \
        if (status != STARG_OK)                                                                    \
            goto done;                                                                             \
    } while (0)

/* Seconds of a monotonic clock. */
double starg_clock(void) STARG_PRIVATE(starg_clock);

/* True when the time limit has passed. */
bool starg_time_is_over(const starg_context *context) STARG_PRIVATE(starg_time_is_over);

/* Between these two, which may be nested, there is nothing to show before all is done: the time
 * limit ends the call as a cancellation would, with STARG_ERROR_TIME. */
void starg_deadline_begin(starg_context *context) STARG_PRIVATE(starg_deadline_begin);
void starg_deadline_end(starg_context *context) STARG_PRIVATE(starg_deadline_end);

/* Has the time limit passed in such a call? */
bool starg_deadline_struck(const starg_context *context);

/* STARG_ERROR_CANCELLED (with its message set) once a cancellation was asked for; STARG_ERROR_TIME
 * where the deadline has struck. Cheap. */
starg_status starg_check_cancel(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_check_cancel);

/* Records the detail of a failure and returns `status`, so that callers can return the call. */
starg_status starg_fail(starg_context *context, starg_status status, const char *stage,
                        const char *format, ...) STARG_PRIVATE(starg_fail)
    __attribute__((format(printf, 4, 5)));

/* The same with up to STARG_ERROR_INDICES element indices (more are cut off). */
starg_status starg_fail_at(starg_context *context, starg_status status, const char *stage,
                           starg_element element, const uint64_t *indices, size_t count,
                           const char *format, ...) STARG_PRIVATE(starg_fail_at)
    __attribute__((format(printf, 7, 8)));

/* Out of memory in `stage`. */
starg_status starg_fail_memory(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_fail_memory);

/* Out of time in `stage`. */
starg_status starg_fail_time(starg_context *context, const char *stage);

/* Sends a line to the log callback. */
void starg_log(starg_context *context, starg_log_level level, const char *format, ...)
    STARG_PRIVATE(starg_log) __attribute__((format(printf, 3, 4)));

/* Progress of a stage in steps: begin, then step with 0 <= done <= total on the calling thread.
 * step is cheap: it asks the callback at most about 20 times a second. A callback that returns
 * false marks the context cancelled; starg_check_cancel then says so. */
void starg_progress_begin(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_progress_begin);
void starg_progress_step(starg_context *context, size_t done, size_t total)
    STARG_PRIVATE(starg_progress_step);
void starg_progress_end(starg_context *context) STARG_PRIVATE(starg_progress_end);

#endif
