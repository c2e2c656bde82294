/* SPDX-License-Identifier: Apache-2.0 */
/* Threads take items one by one from an atomic counter: an item is a visibility row or similar, so
 * the counter is never the bottleneck. The calling thread works too, unless it serves other
 * processes (core/distribute.c). */
#include "core/parallel.h"

#include "core/workers.h"

void worker_group_fail(worker_group *group, size_t item, starg_status status) {
    atomic_store(&group->stop, true);
    mtx_lock(&group->lock);
    if (group->failed_status == STARG_OK || item < group->failed_item) {
        group->failed_item = item;
        group->failed_status = status;
    }
    mtx_unlock(&group->lock);
}

bool worker_group_must_stop(worker_group *group, size_t item) {
    if (atomic_load(&group->stop))
        return true;
    if (atomic_load(&group->context->cancelled))
        worker_group_fail(group, item, STARG_ERROR_CANCELLED);
    else if (starg_time_has_failed(group->context))
        worker_group_fail(group, item, STARG_ERROR_TIME);
    return atomic_load(&group->stop);
}

void worker_group_finish(worker_group *group, size_t first, size_t count) {
    for (size_t i = first; group->is_finished != NULL && i < first + count; i++)
        atomic_store(&group->is_finished[i], 1);
    atomic_fetch_add(&group->finished, count);
}

static void advance(worker_group *group) {
    const starg_parallel_loop *loop = group->loop;
    size_t reached = group->advanced;
    while (reached < loop->count && atomic_load(&group->is_finished[reached]))
        reached++;
    if (reached == group->advanced || group->calling_status != STARG_OK)
        return;
    group->advanced = reached;
    group->calling_status = loop->advance(group->context, loop->shared, reached);
    if (group->calling_status != STARG_OK)
        atomic_store(&group->stop, true);
}

void worker_group_report(worker_group *group) {
    const starg_parallel_loop *loop = group->loop;
    if (loop->advance != NULL)
        advance(group);
    if (!loop->silent)
        starg_progress_step(group->context, atomic_load(&group->finished), loop->count);
}

static size_t next_item(worker_group *group) {
    return atomic_fetch_add(&group->next, 1);
}

static void work(worker_group *group, bool calling) {
    const starg_parallel_loop *loop = group->loop;
    void *scratch = NULL;
    if (loop->make_scratch != NULL) {
        starg_status status = loop->make_scratch(group->context, loop->shared, &scratch);
        if (status != STARG_OK) {
            worker_group_fail(group, 0, status);
            return;
        }
    }
    /* The calling thread takes the first item, which others leave to it. */
    size_t item = calling ? 0 : next_item(group);
    for (; item < loop->count && !worker_group_must_stop(group, item); item = next_item(group)) {
        starg_status status = loop->item(group->context, loop->shared, scratch, item);
        if (status == STARG_OK)
            worker_group_finish(group, item, 1);
        else
            worker_group_fail(group, item, status);
        if (calling)
            worker_group_report(group);
    }
    if (loop->free_scratch != NULL)
        loop->free_scratch(group->context, scratch);
}

static void help(void *given) {
    worker_group *group = given;
    starg_item_scope former = starg_item_enter(group->context, group->rule);
    work(group, false);
    starg_item_leave(former);
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

/* Number of threads that work besides the calling one. */
static size_t count_threads(const worker_group *group, bool shared) {
    size_t threads = (size_t)group->context->threads - !shared, count = group->loop->count;
    size_t most = shared || count == 0 ? count : count - 1;
    return threads < most ? threads : most;
}

static starg_status prepare(worker_group *group) {
    starg_context *context = group->context;
    const char *stage = group->loop->stage;
    if (group->loop->advance != NULL)
        NEW_ZERO(context, stage, group->is_finished, group->loop->count);
    if (mtx_init(&group->lock, mtx_plain) != thrd_success)
        return starg_fail_memory(context, stage);
    return STARG_OK;
}

starg_status starg_parallel_for(starg_context *context, const starg_parallel_loop *loop) {
    starg_status status = STARG_OK;
    bool shared = loop->remote != NULL && context->ranks != NULL && loop->count > 1;
    worker_group group = {
        .context = context, .loop = loop, .rule = starg_time_rule_of(context), .next = !shared};
    workers_task helpers = {
        .run = help, .argument = &group, .wanted = count_threads(&group, shared)};
    bool helped = false;
    if (!loop->silent)
        starg_progress_begin_part(context, loop->stage, loop->share);
    STARG_TRY(prepare(&group));

    /* If a thread cannot be started, the others do its share. */
    if (helpers.wanted > 0) {
        helped = workers_begin(context, &helpers);
        if (!helped)
            worker_group_fail(&group, 0, STARG_ERROR_MEMORY);
    }
    if (shared)
        worker_group_distribute(&group);
    else
        work(&group, true);
    if (helped)
        workers_end(context, &helpers);
    if (loop->advance != NULL)
        advance(&group);

    mtx_destroy(&group.lock);
    status = group.calling_status;
    if (status == STARG_OK)
        status = explain(context, loop->stage, group.failed_status);
done:
    if (!loop->silent)
        starg_progress_end(context);
    starg_release(context, group.is_finished);
    return status;
}

starg_status starg_parallel_in_time(starg_context *context, const starg_parallel_loop *loop) {
    starg_time_rule former = starg_time_begin(context, STARG_TIME_FAILS);
    starg_status status = starg_parallel_for(context, loop);
    starg_time_end(context, former);
    return status;
}

/* ---- a few tasks ---- */

typedef struct task_run {
    const starg_tasks *tasks;
    starg_status status[STARG_TASKS_MOST];
} task_run;

static starg_status run_task(starg_context *context, void *shared, void *scratch, size_t item) {
    task_run *all = shared;
    (void)scratch;
    all->status[item] = all->tasks->run(context, all->tasks->shared, item);
    return STARG_OK;
}

starg_status starg_run_tasks(starg_context *context, const starg_tasks *tasks) {
    task_run all = {.tasks = tasks};
    const starg_parallel_loop loop = {.stage = tasks->stage,
                                      .count = tasks->count,
                                      .shared = &all,
                                      .item = run_task,
                                      .silent = true};
    bool done = true;
    TRY(starg_parallel_for(context, &loop));
    for (size_t i = 0; i < tasks->count; i++) {
        if (all.status[i] == STARG_ERROR_MEMORY)
            return starg_fail_memory(context, tasks->stage);
        done = done && all.status[i] == STARG_OK;
    }
    for (size_t i = 0; i < tasks->count && !done; i++) {
        tasks->undo(tasks->shared, i);
        TRY(tasks->run(context, tasks->shared, i));
    }
    return STARG_OK;
}
