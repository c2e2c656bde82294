/* SPDX-License-Identifier: Apache-2.0 */
/* Worker threads, started when first needed. Each sleeps until calls are wanted, makes one, and
 * sleeps again. Calls of the latest task come first: those of an inner loop, which an item of an
 * outer one waits for. A thread that waits for calls to end makes others in the meantime.
 *
 * After fork() a child has the memory of its parent's threads, but not the threads; it starts its
 * own. */
#include "core/workers.h"

#include <threads.h>
#include <unistd.h>

struct starg_workers {
    pid_t process;
    mtx_t lock;         /* guards all below, and the tasks */
    cnd_t wake;         /* for workers: a call is wanted */
    cnd_t turn;         /* for waiting threads: the same, or a task's last running call has ended */
    workers_task *last; /* begun and not ended; NULL: none */
    bool over;          /* the threads shall end */
    size_t count, room;
    thrd_t threads[];
};

/* ---- calls, with the lock held ---- */

static workers_task *find_wanted(const starg_workers *w) {
    workers_task *task = w->last;
    while (task != NULL && task->wanted == 0)
        task = task->former;
    return task;
}

static void call(starg_workers *w, workers_task *task) {
    task->wanted--;
    task->running++;
    mtx_unlock(&w->lock);
    task->run(task->argument);
    mtx_lock(&w->lock);
    if (--task->running == 0)
        cnd_broadcast(&w->turn);
}

static int worker_main(void *given) {
    starg_workers *w = given;
    mtx_lock(&w->lock);
    while (!w->over) {
        workers_task *task = find_wanted(w);
        if (task != NULL)
            call(w, task);
        else
            cnd_wait(&w->wake, &w->lock);
    }
    mtx_unlock(&w->lock);
    return 0;
}

/* ---- threads ---- */

static bool make_locks(starg_workers *w) {
    if (mtx_init(&w->lock, mtx_plain) != thrd_success)
        return false;
    if (cnd_init(&w->wake) == thrd_success) {
        if (cnd_init(&w->turn) == thrd_success)
            return true;
        cnd_destroy(&w->wake);
    }
    mtx_destroy(&w->lock);
    return false;
}

/* Those of this process; NULL if there is no memory. */
static starg_workers *workers_of(starg_context *context) {
    const starg_allocator *allocator = &context->allocator;
    starg_workers *w = context->workers;
    if (w != NULL && w->process == getpid())
        return w;
    size_t room = (size_t)context->threads;
    w = allocator->allocate(allocator->user, sizeof *w + room * sizeof *w->threads);
    if (w == NULL)
        return NULL;
    *w = (starg_workers){.process = getpid(), .room = room};
    if (!make_locks(w)) {
        allocator->release(allocator->user, w);
        return NULL;
    }
    return context->workers = w;
}

bool workers_begin(starg_context *context, workers_task *task) {
    starg_workers *w = workers_of(context);
    if (w == NULL)
        return false;
    mtx_lock(&w->lock);
    while (w->count < task->wanted && w->count < w->room &&
           thrd_create(&w->threads[w->count], worker_main, w) == thrd_success)
        w->count++;
    task->former = w->last;
    w->last = task;
    for (size_t i = 0; i < task->wanted && i < w->count; i++)
        cnd_signal(&w->wake);
    cnd_broadcast(&w->turn);
    mtx_unlock(&w->lock);
    return true;
}

void workers_end(starg_context *context, workers_task *task) {
    starg_workers *w = context->workers;
    workers_task **at = &w->last;
    mtx_lock(&w->lock);
    task->wanted = 0;
    while (task->running > 0) {
        workers_task *other = find_wanted(w);
        if (other != NULL)
            call(w, other);
        else
            cnd_wait(&w->turn, &w->lock);
    }
    while (*at != task)
        at = &(*at)->former;
    *at = task->former;
    mtx_unlock(&w->lock);
}

void workers_free(starg_context *context) {
    starg_workers *w = context->workers;
    if (w == NULL)
        return;
    if (w->process == getpid()) {
        mtx_lock(&w->lock);
        w->over = true;
        cnd_broadcast(&w->wake);
        mtx_unlock(&w->lock);
        for (size_t i = 0; i < w->count; i++)
            thrd_join(w->threads[i], NULL);
        cnd_destroy(&w->turn);
        cnd_destroy(&w->wake);
        mtx_destroy(&w->lock);
    }
    context->allocator.release(context->allocator.user, w);
}
