/* A loop hands out its items one by one from an atomic counter: items here are whole visibility
 * rows or the like, so that the counter never dominates. */
#include "core/parallel.h"

#include <threads.h>

#include "core/memory.h"

typedef struct team {
    starg_context *context;
    const starg_parallel_loop *loop;
    atomic_size_t next, finished;
    atomic_bool stop;
    mtx_t lock; /* guards the two below */
    size_t failed_item;
    starg_status failed_status;
} team;

static void note_failure(team *crew, size_t item, starg_status status) {
    atomic_store(&crew->stop, true);
    mtx_lock(&crew->lock);
    if (crew->failed_status == STARG_OK || item < crew->failed_item) {
        crew->failed_item = item;
        crew->failed_status = status;
    }
    mtx_unlock(&crew->lock);
}

static bool must_stop(team *crew, size_t item) {
    if (atomic_load(&crew->stop))
        return true;
    if (atomic_load(&crew->context->cancelled))
        note_failure(crew, item, STARG_ERROR_CANCELLED);
    else if (starg_deadline_struck(crew->context) ||
             (crew->loop->stop_at_deadline && starg_time_is_over(crew->context)))
        note_failure(crew, item, STARG_ERROR_TIME);
    return atomic_load(&crew->stop);
}

static void work(team *crew, bool reports) {
    const starg_parallel_loop *loop = crew->loop;
    void *scratch = NULL;
    if (loop->make_scratch != NULL) {
        starg_status status = loop->make_scratch(crew->context, loop->shared, &scratch);
        if (status != STARG_OK) {
            note_failure(crew, 0, status);
            return;
        }
    }
    for (;;) {
        size_t item = atomic_fetch_add(&crew->next, 1);
        if (item >= loop->count || must_stop(crew, item))
            break;
        starg_status status = loop->item(crew->context, loop->shared, scratch, item);
        if (status != STARG_OK)
            note_failure(crew, item, status);
        size_t finished = atomic_fetch_add(&crew->finished, 1) + 1;
        if (reports && !loop->silent)
            starg_progress_step(crew->context, loop->before + finished,
                                loop->whole > 0 ? loop->whole : loop->count);
    }
    if (loop->free_scratch != NULL)
        loop->free_scratch(crew->context, scratch);
}

static int helper_main(void *argument) {
    work(argument, false);
    return 0;
}

static starg_status explain(starg_context *context, const char *stage, starg_status status) {
    switch (status) {
    case STARG_OK:
        return STARG_OK;
    case STARG_ERROR_MEMORY:
        return starg_fail_memory(context, stage);
    case STARG_ERROR_CANCELLED:
        return starg_fail(context, status, stage, "cancelled");
    case STARG_ERROR_TIME:
        return starg_fail_time(context, stage);
    default:
        return starg_fail(context, status, stage, "%s", starg_status_string(status));
    }
}

starg_status starg_parallel_for(starg_context *context, const starg_parallel_loop *loop) {
    team crew = {.context = context, .loop = loop, .failed_status = STARG_OK};
    size_t helpers = (size_t)context->threads - 1;
    if (helpers + 1 > loop->count)
        helpers = loop->count > 0 ? loop->count - 1 : 0;

    if (loop->whole == 0)
        if (!loop->silent)
            starg_progress_begin(context, loop->stage);
    thrd_t *threads = helpers ? starg_allocate(context, helpers, sizeof *threads) : NULL;
    if (helpers != 0 && threads == NULL)
        return starg_fail_memory(context, loop->stage);
    if (mtx_init(&crew.lock, mtx_plain) != thrd_success) {
        starg_release(context, threads);
        return starg_fail_memory(context, loop->stage);
    }

    /* A thread that cannot be started is no failure: the others do its share. */
    size_t started = 0;
    while (started < helpers && thrd_create(&threads[started], helper_main, &crew) == thrd_success)
        started++;
    work(&crew, true);
    for (size_t i = 0; i < started; i++)
        thrd_join(threads[i], NULL);

    mtx_destroy(&crew.lock);
    starg_release(context, threads);
    if (loop->whole == 0)
        if (!loop->silent)
            starg_progress_end(context);
    return explain(context, loop->stage, crew.failed_status);
}
