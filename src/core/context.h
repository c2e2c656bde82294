/* SPDX-License-Identifier: Apache-2.0 */
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

/* What the time limit does to the code under way. */
typedef enum starg_time_rule {
    STARG_TIME_SHORTENS, /* searches look at the clock and return the best they have         */
    STARG_TIME_FAILS,    /* nothing to show before all is done: the call ends with ERROR_TIME */
    STARG_TIME_IGNORED   /* runs to its end                                                  */
} starg_time_rule;

typedef struct starg_deadline {
    double at; /* of starg_clock(); 0: none */
    starg_time_rule rule;
} starg_deadline;

enum { STARG_STAGES = 16 };

/* The stages under way, the innermost last. */
typedef struct starg_progress {
    starg_progress_fn *report; /* NULL: none */
    void *user;
    double pause, next; /* seconds between two steps that are reported; when the next is due */
    struct {
        const char *name;
        double fraction, share; /* share: of the stage around it */
    } stages[STARG_STAGES];
    size_t depth; /* what is deeper than STARG_STAGES is not reported */
} starg_progress;

struct starg_context {
    starg_allocator allocator;
    int threads;
    uint64_t seed;
    starg_log_fn *log;
    void *log_user;

    atomic_bool cancelled;
    starg_deadline deadline;

    const starg_ranks *ranks; /* whom the work is shared with, or NULL */
    uint64_t shared_loops;    /* so far: the number of the last one    */
    double shared_seconds;    /* spent in them                         */
    uint64_t helped_items;    /* of them, that others have worked on   */

    atomic_size_t live_bytes, peak_bytes, live_blocks;

    starg_progress progress;

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

/* Puts what follows under a rule, until starg_time_end gets what this returned. Inside of another
 * rule the later one of the enum holds: what runs to its end does so with all its parts. */
starg_time_rule starg_time_begin(starg_context *context, starg_time_rule rule)
    STARG_PRIVATE(starg_time_begin);
void starg_time_end(starg_context *context, starg_time_rule former) STARG_PRIVATE(starg_time_end);

/* Seconds until the time limit, negative once it has passed; INFINITY where there is none or it is
 * ignored. */
double starg_seconds_left(const starg_context *context) STARG_PRIVATE(starg_seconds_left);

/* True when the time limit has passed and is not ignored. */
bool starg_time_is_over(const starg_context *context) STARG_PRIVATE(starg_time_is_over);

/* True when it has passed and ends the call. */
bool starg_time_has_failed(const starg_context *context) STARG_PRIVATE(starg_time_has_failed);

/* STARG_ERROR_CANCELLED (with its message set) once a cancellation was asked for; STARG_ERROR_TIME
 * where the time limit ends the call. Cheap. */
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

/* Progress of a stage: begin, steps with 0 <= done <= total, end, on the calling thread; end on
 * every way out. Stages nest. The callback gets the innermost one: 0 at its begin, 1 at its end,
 * between them ascending fractions above 0 and below 1, at most about 20 a second. A part takes
 * the stage around it along by its `share`; a stage in one of the same name goes on with that.
 * A callback that returns false marks the context cancelled; starg_check_cancel then says so. */
void starg_progress_begin(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_progress_begin);
void starg_progress_begin_part(starg_context *context, const char *stage, double share)
    STARG_PRIVATE(starg_progress_begin_part);
void starg_progress_step(starg_context *context, size_t done, size_t total)
    STARG_PRIVATE(starg_progress_step);
void starg_progress_end(starg_context *context) STARG_PRIVATE(starg_progress_end);

#endif
