/* A loop hands out its items one by one from an atomic counter: items here are whole visibility
 * rows or the like, so that the counter never dominates. The calling thread works like the others,
 * unless it has to deal with other processes (core/share.c). */
#include "core/parallel.h"

#include "core/team.h"

void team_fail(team *crew, size_t item, starg_status status) {
    atomic_store(&crew->stop, true);
    mtx_lock(&crew->lock);
    if (crew->failed_status == STARG_OK || item < crew->failed_item) {
        crew->failed_item = item;
        crew->failed_status = status;
    }
    mtx_unlock(&crew->lock);
}

bool team_must_stop(team *crew, size_t item) {
    if (atomic_load(&crew->stop))
        return true;
    if (atomic_load(&crew->context->cancelled))
        team_fail(crew, item, STARG_ERROR_CANCELLED);
    else if (starg_time_has_failed(crew->context))
        team_fail(crew, item, STARG_ERROR_TIME);
    return atomic_load(&crew->stop);
}

void team_finish(team *crew, size_t first, size_t count) {
    for (size_t i = first; crew->is_finished != NULL && i < first + count; i++)
        atomic_store(&crew->is_finished[i], 1);
    atomic_fetch_add(&crew->finished, count);
}

static void advance(team *crew) {
    const starg_parallel_loop *loop = crew->loop;
    size_t reached = crew->advanced;
    while (reached < loop->count && atomic_load(&crew->is_finished[reached]))
        reached++;
    if (reached == crew->advanced || crew->calling_status != STARG_OK)
        return;
    crew->advanced = reached;
    crew->calling_status = loop->advance(crew->context, loop->shared, reached);
    if (crew->calling_status != STARG_OK)
        atomic_store(&crew->stop, true);
}

void team_report(team *crew) {
    const starg_parallel_loop *loop = crew->loop;
    if (loop->advance != NULL)
        advance(crew);
    if (!loop->silent)
        starg_progress_step(crew->context, atomic_load(&crew->finished), loop->count);
}

static void work(team *crew, bool calling) {
    const starg_parallel_loop *loop = crew->loop;
    void *scratch = NULL;
    if (loop->make_scratch != NULL) {
        starg_status status = loop->make_scratch(crew->context, loop->shared, &scratch);
        if (status != STARG_OK) {
            team_fail(crew, 0, status);
            return;
        }
    }
    for (;;) {
        size_t item = atomic_fetch_add(&crew->next, 1);
        if (item >= loop->count || team_must_stop(crew, item))
            break;
        starg_status status = loop->item(crew->context, loop->shared, scratch, item);
        if (status == STARG_OK)
            team_finish(crew, item, 1);
        else
            team_fail(crew, item, status);
        if (calling)
            team_report(crew);
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

/* How many threads to start besides the calling one. */
static size_t count_threads(const team *crew, bool shared) {
    size_t threads = (size_t)crew->context->threads - !shared, count = crew->loop->count;
    size_t most = shared || count == 0 ? count : count - 1;
    return threads < most ? threads : most;
}

static starg_status prepare(team *crew, size_t helpers, thrd_t **threads) {
    starg_status status = STARG_OK;
    starg_context *context = crew->context;
    const char *stage = crew->loop->stage;
    if (helpers > 0)
        STARG_NEW(context, stage, *threads, helpers);
    if (crew->loop->advance != NULL)
        STARG_NEW_ZERO(context, stage, crew->is_finished, crew->loop->count);
    if (mtx_init(&crew->lock, mtx_plain) != thrd_success)
        status = starg_fail_memory(context, stage);
done:
    return status;
}

starg_status starg_parallel_for(starg_context *context, const starg_parallel_loop *loop) {
    starg_status status = STARG_OK;
    team crew = {.context = context, .loop = loop};
    bool shared = loop->remote != NULL && context->ranks != NULL && loop->count > 1;
    size_t helpers = count_threads(&crew, shared), started = 0;
    thrd_t *threads = NULL;
    if (!loop->silent)
        starg_progress_begin_part(context, loop->stage, loop->share);
    STARG_TRY(prepare(&crew, helpers, &threads));

    /* A thread that cannot be started is no failure: the others do its share. */
    while (started < helpers && thrd_create(&threads[started], helper_main, &crew) == thrd_success)
        started++;
    if (shared)
        team_share(&crew);
    else
        work(&crew, true);
    for (size_t i = 0; i < started; i++)
        thrd_join(threads[i], NULL);
    if (loop->advance != NULL)
        advance(&crew);

    mtx_destroy(&crew.lock);
    status = crew.calling_status;
    if (status == STARG_OK)
        status = explain(context, loop->stage, crew.failed_status);
done:
    if (!loop->silent)
        starg_progress_end(context);
    starg_release(context, threads);
    starg_release(context, crew.is_finished);
    return status;
}

starg_status starg_parallel_in_time(starg_context *context, const starg_parallel_loop *loop) {
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    starg_status status = starg_parallel_for(context, loop);
    starg_time_end(context, former);
    return status;
}
