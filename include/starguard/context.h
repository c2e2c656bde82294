/* SPDX-License-Identifier: Apache-2.0 */
/* The context shared by all calls (memory, threads, seed, callbacks) and the details of the last
 * error.
 *
 * Threads: only one thread at a time may use a context; different contexts are independent.
 * Exceptions: starg_context_cancel and starg_context_finish may be called from any thread and any
 * signal handler. Finished objects (meshes, matrices, results) are immutable and may be shared
 * freely. Free an object before the context that created it, because its memory returns there. */
#ifndef STARGUARD_CONTEXT_H
#define STARGUARD_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "export.h"
#include "status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_context starg_context;

/* Memory hooks. Both may be called from several threads at once.
 * allocate: a block of at least `size` (> 0) bytes aligned for any type, or NULL.
 * release: frees a block of allocate; never called with NULL. */
typedef struct starg_allocator {
    void *(*allocate)(void *user, size_t size);
    void (*release)(void *user, void *block);
    void *user;
} starg_allocator;

typedef enum starg_log_level { STARG_LOG_NOTICE = 0, STARG_LOG_WARNING = 1 } starg_log_level;

/* Receives one line of text without a newline; called on the calling thread. */
typedef void starg_log_fn(void *user, starg_log_level level, const char *message);

/* Called on the calling thread while a stage runs. `stage` is a static lower-case name. `fraction`
 * is 0 when the stage begins, increases, and is 1 when it ends. Stages nest: an inner stage ends
 * before its outer stage continues. Return false to cancel: the call soon returns
 * STARG_ERROR_CANCELLED. */
typedef bool starg_progress_fn(void *user, const char *stage, double fraction);

typedef struct starg_context_options {
    starg_allocator allocator; /* all zero: malloc and free                                   */
    int threads;               /* 0: all cores; at most 1024 */
    uint64_t seed;             /* of all random numbers */
    starg_log_fn *log;         /* NULL: notices and warnings are dropped                      */
    void *log_user;
    starg_progress_fn *progress; /* NULL: none                                                */
    void *progress_user;
} starg_context_options;

/* Fills `options` with the defaults: malloc, all threads, seed 1, no callbacks. */
STARG_API void starg_context_options_default(starg_context_options *options);

/* Creates a context. `options` may be NULL for the defaults. *out is NULL on failure. Errors:
 * ARGUMENT (threads below 0 or above 1024, only one memory hook set), MEMORY. */
STARG_API starg_status starg_context_create(const starg_context_options *options,
                                            starg_context **out);

/* Frees the context; NULL is allowed. */
STARG_API void starg_context_free(starg_context *context);

/* Frees a text returned by a function; NULL is allowed. */
STARG_API void starg_text_free(starg_context *context, char *text);

/* Stops the running call, or the next one if none is running. Async-signal-safe. */
STARG_API void starg_context_cancel(starg_context *context);

/* Ends searches of the running call, or of the next one, as if a time limit had just passed: they
 * return their best result, marked as time-limited. Other work goes on. Async-signal-safe. */
STARG_API void starg_context_finish(starg_context *context);

/* In a progress callback: how many guards or pieces the best result of the running search has so
 * far, and which (`what`, may be NULL: "guards", "pieces"); 0: there is none yet. */
STARG_API size_t starg_context_best(const starg_context *context, const char **what);

/* Clears a cancellation, or a request to finish, so that the context can be used again. */
STARG_API void starg_context_reset(starg_context *context);

/* Wall-clock limit for all following calls, in seconds from now; 0 or less: none. A search that
 * reaches the limit returns its best result, marked as time-limited; a call without a partial
 * result (a check, a skeleton, a map) returns STARG_ERROR_TIME. */
STARG_API void starg_context_set_time_limit(starg_context *context, double seconds);

/* Memory allocated by the context: peak bytes, and blocks not yet released. */
STARG_API size_t starg_context_peak_bytes(const starg_context *context);
STARG_API size_t starg_context_live_blocks(const starg_context *context);

/* Work that searches of this context have counted so far, in units of about a microsecond: the same
 * for the same calls, on every machine and at any number of threads. */
STARG_API uint64_t starg_context_work(const starg_context *context);

/* The kind of element that indices of an error refer to. */
typedef enum starg_element {
    STARG_ELEMENT_NONE = 0,
    STARG_ELEMENT_VERTEX = 1,
    STARG_ELEMENT_FACE = 2,
    STARG_ELEMENT_EDGE = 3, /* pairs of vertex indices */
    STARG_ELEMENT_LINE = 4, /* of a text file, from 1 */
    STARG_ELEMENT_BYTE = 5, /* of a binary file, from 0 */
    STARG_ELEMENT_GUARD = 6,
    STARG_ELEMENT_CANDIDATE = 7,
    STARG_ELEMENT_TETRAHEDRON = 8
} starg_element;

enum { STARG_ERROR_INDICES = 8 };

/* Details of the last failed call on a context. */
typedef struct starg_error {
    starg_status status;
    const char *stage;   /* static lower-case name of the part that failed */
    const char *message; /* one or two sentences: what, where, what to do  */
    starg_element element;
    size_t index_count; /* used entries of indices, at most STARG_ERROR_INDICES */
    uint64_t indices[STARG_ERROR_INDICES];
} starg_error;

/* Details of the last failure; status is STARG_OK if there was none. Owned by the context and valid
 * until its next call. */
STARG_API const starg_error *starg_context_error(const starg_context *context);

#ifdef __cplusplus
}
#endif

#endif
