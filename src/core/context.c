/* SPDX-License-Identifier: Apache-2.0 */
#include "core/context.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "core/workers.h"
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
        return "lost connection to another process";
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
    const bool resizes = allocator.allocate == NULL;
    if (allocator.allocate == NULL) {
        allocator.allocate = default_allocate;
        allocator.release = default_release;
    }

    starg_context *context = allocator.allocate(allocator.user, sizeof *context);
    if (context == NULL)
        return STARG_ERROR_MEMORY;
    *context = (starg_context){
        .allocator = allocator,
        .resizes = resizes,
        .threads = options->threads ? options->threads : machine_threads(),
        .seed = options->seed,
        .log = options->log,
        .log_user = options->log_user,
        .progress = {.report = options->progress, .user = options->progress_user, .pause = 0.05}};
    atomic_flag_clear(&context->recording);
    context->error.stage = "";
    context->error.message = context->message;
    *out = context;
    return STARG_OK;
}

void starg_context_free(starg_context *context) {
    if (context == NULL)
        return;
    workers_free(context);
    starg_allocator allocator = context->allocator;
    allocator.release(allocator.user, context);
}

void starg_context_cancel(starg_context *context) {
    atomic_store(&context->cancelled, true);
}

void starg_context_finish(starg_context *context) {
    atomic_store(&context->finishes, true);
}

size_t starg_context_best(const starg_context *context, const char **what) {
    if (what != NULL)
        *what = context->best > 0 ? context->best_of : "";
    return context->best;
}

void starg_context_reset(starg_context *context) {
    atomic_store(&context->cancelled, false);
    atomic_store(&context->finishes, false);
}

double starg_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void starg_context_set_time_limit(starg_context *context, double seconds) {
    context->deadline.at = seconds > 0 ? starg_clock() + seconds : 0;
    context->deadline.grace = fmax(0.5, 0.1 * seconds);
}

/* ---- items of a loop, on other threads than the one that calls the library ---- */

static _Thread_local starg_item_scope item;

starg_item_scope starg_item_enter(const starg_context *context, starg_time_rule rule) {
    starg_item_scope former = item;
    item = (starg_item_scope){context, rule};
    return former;
}

void starg_item_leave(starg_item_scope former) {
    item = former;
}

/* ---- time ---- */

starg_time_rule starg_time_rule_of(const starg_context *context) {
    return item.context == context ? item.rule : context->deadline.rule;
}

static void set_rule(starg_context *context, starg_time_rule rule) {
    if (item.context == context)
        item.rule = rule;
    else
        context->deadline.rule = rule;
}

starg_time_rule starg_time_begin(starg_context *context, starg_time_rule rule) {
    starg_time_rule former = starg_time_rule_of(context);
    if (rule > former)
        set_rule(context, rule);
    return former;
}

void starg_time_end(starg_context *context, starg_time_rule former) {
    set_rule(context, former);
}

double starg_seconds_left(const starg_context *context) {
    const starg_deadline *deadline = &context->deadline;
    if (deadline->at <= 0 || starg_time_rule_of(context) == STARG_TIME_IGNORED)
        return INFINITY;
    return deadline->at - starg_clock();
}

bool starg_time_is_over(const starg_context *context) {
    return starg_seconds_left(context) <= 0 ||
           (starg_time_rule_of(context) == STARG_TIME_SHORTENS &&
            atomic_load_explicit(&context->finishes, memory_order_relaxed));
}

bool starg_time_is_long_over(const starg_context *context) {
    return starg_seconds_left(context) <= -context->deadline.grace;
}

bool starg_time_has_failed(const starg_context *context) {
    return starg_time_rule_of(context) == STARG_TIME_FAILS && starg_time_is_over(context);
}

size_t starg_context_peak_bytes(const starg_context *context) {
    return atomic_load(&context->peak_bytes);
}

uint64_t starg_context_work(const starg_context *context) {
    return context->work;
}

size_t starg_context_live_blocks(const starg_context *context) {
    return atomic_load(&context->live_blocks);
}

const starg_error *starg_context_error(const starg_context *context) {
    return &context->error;
}

static void record(starg_context *context, starg_status status, const char *stage,
                   const char *format, va_list arguments) {
    while (atomic_flag_test_and_set(&context->recording)) {
    }
    context->error = (starg_error){.status = status, .stage = stage, .message = context->message};
    vsnprintf(context->message, sizeof context->message, format, arguments);
    atomic_flag_clear(&context->recording);
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
                      "time limit reached in stage '%s' without a result; allow more time", stage);
}

starg_status starg_check_cancel(starg_context *context, const char *stage) {
    if (starg_time_has_failed(context))
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

/* ---- progress ---- */

static const double ALMOST = 1 - 0x1p-20; /* only the end of a stage reports 1 */

/* The stage to report: among nested stages of one name, the outermost. */
static size_t shown_stage(const starg_progress *p) {
    size_t shown = p->depth - 1;
    while (shown > 0 && strcmp(p->stages[shown].name, p->stages[shown - 1].name) == 0)
        shown--;
    return shown;
}

static void report(starg_context *context, const char *stage, double fraction) {
    starg_progress *p = &context->progress;
    if (!p->report(p->user, stage, fraction))
        starg_context_cancel(context);
    p->next = starg_clock() + p->pause;
}

/* Sets a stage's fraction and adds its share to the stages around it. */
static void advance(starg_progress *p, size_t stage, double fraction) {
    double gained = fraction - p->stages[stage].fraction;
    if (!(gained > 0))
        return;
    p->stages[stage].fraction = fraction;
    if (stage > 0)
        advance(p, stage - 1,
                fmin(p->stages[stage - 1].fraction + gained * p->stages[stage].share, ALMOST));
}

void starg_progress_begin(starg_context *context, const char *stage) {
    starg_progress_begin_part(context, stage, 0);
}

void starg_progress_begin_part(starg_context *context, const char *stage, double share) {
    starg_progress *p = &context->progress;
    if (item.context == context || p->depth++ >= STARG_STAGES)
        return;
    p->stages[p->depth - 1].name = stage;
    p->stages[p->depth - 1].fraction = 0;
    p->stages[p->depth - 1].share = share;
    if (p->report != NULL && shown_stage(p) == p->depth - 1)
        report(context, stage, 0);
}

void starg_progress_step(starg_context *context, size_t done, size_t total) {
    starg_progress *p = &context->progress;
    if (item.context == context || p->report == NULL || p->depth == 0 || p->depth > STARG_STAGES)
        return;
    advance(p, p->depth - 1, total > 0 ? fmin((double)done / (double)total, ALMOST) : ALMOST);
    size_t shown = shown_stage(p);
    if (p->stages[shown].fraction > 0 && starg_clock() >= p->next)
        report(context, p->stages[shown].name, p->stages[shown].fraction);
}

void starg_progress_end(starg_context *context) {
    starg_progress *p = &context->progress;
    if (item.context == context)
        return;
    if (p->depth <= STARG_STAGES) {
        advance(p, p->depth - 1, 1);
        if (p->report != NULL && shown_stage(p) == p->depth - 1)
            report(context, p->stages[p->depth - 1].name, 1);
    }
    p->depth--;
}

starg_context *starg_stage_enter(starg_context *context, const char *stage, double share) {
    starg_progress_begin_part(context, stage, share);
    return context;
}

void starg_stage_leave(starg_context **context) {
    starg_progress_end(*context);
}
