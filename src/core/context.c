#include "core/context.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "starguard/version.h"

#define TEXT_(X) #X
#define TEXT(X)  TEXT_(X)

enum { MAX_THREADS = 1024 };

const char *starg_version(void) {
    return TEXT(STARG_VERSION_MAJOR) "." TEXT(STARG_VERSION_MINOR) "." TEXT(STARG_VERSION_PATCH);
}

const char *starg_status_string(starg_status status) {
    switch (status) {
    case STARG_OK:
        return "no error";
    case STARG_ERROR_ARGUMENT:
        return "invalid argument";
    case STARG_ERROR_MEMORY:
        return "out of memory";
    case STARG_ERROR_READ:
        return "cannot read";
    case STARG_ERROR_WRITE:
        return "cannot write";
    case STARG_ERROR_FORMAT:
        return "malformed file";
    case STARG_ERROR_MESH:
        return "mesh not usable";
    case STARG_ERROR_RANGE:
        return "coordinate out of range";
    case STARG_ERROR_SOLVER:
        return "solver failed";
    case STARG_ERROR_TIME:
        return "time limit reached";
    case STARG_ERROR_CANCELLED:
        return "cancelled";
    case STARG_ERROR_RANK:
        return "another process is lost";
    }
    return "unknown status";
}

static void *default_allocate(void *user, size_t size) {
    (void)user;
    return malloc(size);
}

static void default_release(void *user, void *block) {
    (void)user;
    free(block);
}

void starg_context_options_default(starg_context_options *options) {
    *options = (starg_context_options){.seed = 1};
}

static int machine_threads(void) {
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    if (online < 1)
        return 1;
    return online > MAX_THREADS ? MAX_THREADS : (int)online;
}

starg_status starg_context_create(const starg_context_options *options, starg_context **out) {
    *out = NULL;
    starg_context_options defaults;
    starg_context_options_default(&defaults);
    if (options == NULL)
        options = &defaults;

    starg_allocator allocator = options->allocator;
    if ((allocator.allocate == NULL) != (allocator.release == NULL))
        return STARG_ERROR_ARGUMENT;
    if (options->threads < 0 || options->threads > MAX_THREADS)
        return STARG_ERROR_ARGUMENT;
    if (allocator.allocate == NULL) {
        allocator.allocate = default_allocate;
        allocator.release = default_release;
    }

    starg_context *context = allocator.allocate(allocator.user, sizeof *context);
    if (context == NULL)
        return STARG_ERROR_MEMORY;
    *context = (starg_context){.allocator = allocator,
                               .threads = options->threads ? options->threads : machine_threads(),
                               .seed = options->seed,
                               .log = options->log,
                               .log_user = options->log_user,
                               .progress = options->progress,
                               .progress_user = options->progress_user};
    context->error.stage = "";
    context->error.message = context->message;
    *out = context;
    return STARG_OK;
}

void starg_context_free(starg_context *context) {
    if (context == NULL)
        return;
    starg_allocator allocator = context->allocator;
    allocator.release(allocator.user, context);
}

void starg_context_cancel(starg_context *context) {
    atomic_store(&context->cancelled, true);
}

void starg_context_reset(starg_context *context) {
    atomic_store(&context->cancelled, false);
}

double starg_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void starg_context_set_time_limit(starg_context *context, double seconds) {
    context->deadline = seconds > 0 ? starg_clock() + seconds : 0;
}

bool starg_time_is_over(const starg_context *context) {
    return context->deadline > 0 && starg_clock() >= context->deadline;
}

size_t starg_context_peak_bytes(const starg_context *context) {
    return atomic_load(&context->peak_bytes);
}

size_t starg_context_live_blocks(const starg_context *context) {
    return atomic_load(&context->live_blocks);
}

const starg_error *starg_context_error(const starg_context *context) {
    return &context->error;
}

static void record(starg_context *context, starg_status status, const char *stage,
                   const char *format, va_list arguments) {
    context->error = (starg_error){.status = status, .stage = stage, .message = context->message};
    vsnprintf(context->message, sizeof context->message, format, arguments);
}

starg_status starg_fail(starg_context *context, starg_status status, const char *stage,
                        const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    record(context, status, stage, format, arguments);
    va_end(arguments);
    return status;
}

starg_status starg_fail_at(starg_context *context, starg_status status, const char *stage,
                           starg_element element, const uint64_t *indices, size_t count,
                           const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    record(context, status, stage, format, arguments);
    va_end(arguments);
    context->error.element = element;
    context->error.index_count = count < STARG_ERROR_INDICES ? count : STARG_ERROR_INDICES;
    memcpy(context->error.indices, indices, context->error.index_count * sizeof *indices);
    return status;
}

starg_status starg_fail_memory(starg_context *context, const char *stage) {
    return starg_fail(context, STARG_ERROR_MEMORY, stage, "out of memory");
}

starg_status starg_fail_time(starg_context *context, const char *stage) {
    return starg_fail(context, STARG_ERROR_TIME, stage,
                      "the time limit struck in the stage '%s', before there was a result", stage);
}

void starg_deadline_begin(starg_context *context) {
    context->unfinished++;
}

void starg_deadline_end(starg_context *context) {
    context->unfinished--;
}

bool starg_deadline_struck(const starg_context *context) {
    return context->unfinished > 0 && starg_time_is_over(context);
}

starg_status starg_check_cancel(starg_context *context, const char *stage) {
    if (starg_deadline_struck(context))
        return starg_fail_time(context, stage);
    if (!atomic_load_explicit(&context->cancelled, memory_order_relaxed))
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_CANCELLED, stage, "cancelled");
}

void starg_log(starg_context *context, starg_log_level level, const char *format, ...) {
    if (context->log == NULL)
        return;
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    context->log(context->log_user, level, line);
}

static void report(starg_context *context, double fraction) {
    if (!context->progress(context->progress_user, context->progress_stage, fraction))
        starg_context_cancel(context);
    context->progress_next = starg_clock() + 0.05;
}

void starg_progress_begin(starg_context *context, const char *stage) {
    context->progress_stage = stage;
    if (context->progress != NULL)
        report(context, 0);
}

void starg_progress_step(starg_context *context, size_t done, size_t total) {
    if (context->progress != NULL && starg_clock() >= context->progress_next)
        report(context, total ? (double)done / (double)total : 1);
}

void starg_progress_end(starg_context *context) {
    if (context->progress != NULL)
        report(context, 1);
}
