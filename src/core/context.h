/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the context: memory, error detail, cancellation, deadline. */
#pragma once

#include <stdarg.h>
#include <stdatomic.h>

#include "core/compiler.h"
#include "starguard/ranks.h"

typedef struct starg_workers starg_workers; /* core/workers.c */

/* Effect of the time limit on running code. */
typedef enum starg_time_rule {
    STARG_TIME_SHORTENS, /* searches check the clock and return their best result */
    STARG_TIME_FAILS,    /* there is no partial result: the call returns ERROR_TIME */
    STARG_TIME_IGNORED   /* runs to its end */
} starg_time_rule;

typedef struct starg_deadline {
    double at;    /* on starg_clock(); 0: none */
    double grace; /* seconds after that in which what has begun may come to a result */
    starg_time_rule rule;
} starg_deadline;

enum { STARG_STAGES = 16 };

/* Running stages, innermost last. */
typedef struct starg_progress {
    starg_progress_fn *report; /* NULL: none */
    void *user;
    double pause, next; /* seconds between reported steps; time of the next report */
    struct {
        const char *name;
        double fraction, share; /* share: part of the enclosing stage */
    } stages[STARG_STAGES];
    size_t depth; /* stages deeper than STARG_STAGES are not reported */
} starg_progress;

struct starg_context {
    bool resizes; /* the allocator is malloc */
    starg_allocator allocator;
    int threads;
    starg_workers *workers; /* NULL: none started yet */
    uint64_t seed;
    starg_log_fn *log;
    void *log_user;

    atomic_bool cancelled, finishes;
    starg_deadline deadline;

    const starg_ranks *ranks; /* processes that share the work, or NULL */
    uint64_t shared_loops;    /* number of shared loops so far */
    uint64_t work;            /* counted by searches so far, about microseconds */
    size_t best; /* number of `best_of` in the best result of the running search; 0: none */
    const char *best_of;
    uint64_t search_scenes; /* number of search scenes so far */
    uint64_t shared_scene;  /* the search scene that other processes hold; 0: none */
    double shared_seconds;  /* total time in them */
    uint64_t helped_items;  /* their items that other processes computed */

    atomic_size_t live_bytes, peak_bytes, live_blocks;

    starg_progress progress;

    atomic_flag recording; /* an error; threads may fail side by side */
    starg_error error;
    char message[512];
};

/* Evaluates EXPR; on failure jumps to `done` with `status` set. */
#define STARG_TRY(EXPR)                                                                            \
    do {                                                                                           \
        status = (EXPR);                                                                           \
        if (status != STARG_OK)                                                                    \
            goto done;                                                                             \
    } while (0)

/* Monotonic clock in seconds. */
double starg_clock(void) STARG_PRIVATE(starg_clock);

/* Applies a rule until starg_time_end receives the value returned here. When rules nest, the higher
 * enum value wins: code that runs to its end does so with all its parts. */
starg_time_rule starg_time_begin(starg_context *context, starg_time_rule rule)
    STARG_PRIVATE(starg_time_begin);
void starg_time_end(starg_context *context, starg_time_rule former) STARG_PRIVATE(starg_time_end);

/* The one that applies on this thread. */
starg_time_rule starg_time_rule_of(const starg_context *context);

/* While a thread runs items of a loop that another one has called: it has a time rule of its own,
 * and reports no progress. */
typedef struct starg_item_scope {
    const starg_context *context; /* NULL: the thread runs no such items */
    starg_time_rule rule;
} starg_item_scope;

/* Until starg_item_leave receives the value returned here. */
starg_item_scope starg_item_enter(const starg_context *context, starg_time_rule rule);
void starg_item_leave(starg_item_scope former);

/* What the running search has so far; 0 when it ends. */
static inline void starg_tell_best(starg_context *context, size_t count, const char *what) {
    context->best = count;
    context->best_of = what;
}

/* Seconds left, negative after the time limit; INFINITY without a limit or when it is ignored. */
double starg_seconds_left(const starg_context *context) STARG_PRIVATE(starg_seconds_left);

/* True after the time limit, unless it is ignored, and for searches after a request to finish. */
bool starg_time_is_over(const starg_context *context) STARG_PRIVATE(starg_time_is_over);

/* True half a second after it, or a tenth of it if that is longer: too late for what would be the
 * first result. */
bool starg_time_is_long_over(const starg_context *context);

/* True after the time limit, if it ends the call. */
bool starg_time_has_failed(const starg_context *context) STARG_PRIVATE(starg_time_has_failed);

/* STARG_ERROR_CANCELLED (message set) after a cancellation request, STARG_ERROR_TIME when the time
 * limit ends the call. Cheap. */
starg_status starg_check_cancel(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_check_cancel);

/* Records the detail of a failure and returns `status`, so that callers can return the result. */
starg_status starg_fail(starg_context *context, starg_status status, const char *stage,
                        const char *format, ...) STARG_PRIVATE(starg_fail)
    __attribute__((format(printf, 4, 5)));

/* Same, with up to STARG_ERROR_INDICES element indices (the rest is cut off). */
starg_status starg_fail_at(starg_context *context, starg_status status, const char *stage,
                           starg_element element, const uint64_t *indices, size_t count,
                           const char *format, ...) STARG_PRIVATE(starg_fail_at)
    __attribute__((format(printf, 7, 8)));

/* STARG_ERROR_MEMORY in `stage`. */
starg_status starg_fail_memory(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_fail_memory);

/* STARG_ERROR_TIME in `stage`. */
starg_status starg_fail_time(starg_context *context, const char *stage);

/* Sends a line to the log callback. */
void starg_log(starg_context *context, starg_log_level level, const char *format, ...)
    STARG_PRIVATE(starg_log) __attribute__((format(printf, 3, 4)));

/* Progress of a stage, on the thread that calls the library only: begin, steps with 0 <= done <=
 * total, end (on every exit path). Stages nest. The callback receives the innermost stage: 0 at its
 * begin, 1 at its end, and increasing fractions strictly between, at most about 20 a second. A part
 * advances the enclosing stage by its `share`; a stage nested in one of the same name continues it.
 * When the callback returns false, the context is cancelled and starg_check_cancel reports it. */
void starg_progress_begin(starg_context *context, const char *stage)
    STARG_PRIVATE(starg_progress_begin);
void starg_progress_begin_part(starg_context *context, const char *stage, double share)
    STARG_PRIVATE(starg_progress_begin_part);
void starg_progress_step(starg_context *context, size_t done, size_t total)
    STARG_PRIVATE(starg_progress_step);
void starg_progress_end(starg_context *context) STARG_PRIVATE(starg_progress_end);
