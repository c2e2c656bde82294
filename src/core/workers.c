/* SPDX-License-Identifier: Apache-2.0 */
/* Worker threads, started when first needed. Each sleeps until calls are wanted, makes one, and
 * sleeps again.
 *
 * After fork() a child has the memory of its parent's threads, but not the threads; it starts its
 * own. */
#include "core/workers.h"

#include <threads.h>
#include <unistd.h>

struct starg_workers {
    pid_t process;
    atomic_bool in_use; /* between workers_begin and workers_end */
    mtx_t lock;         /* guards all below */
    cnd_t wake, done;
    void (*run)(void *argument);
    void *argument;
    size_t wanted, running; /* calls: not begun, begun */
    bool over;              /* the threads shall end */
    size_t count, room;
    thrd_t threads[];
};

static int worker_main(void *given) {
    starg_workers *w = given;
    mtx_lock(&w->lock);
    for (;;) {
        while (w->wanted == 0 && !w->over)
            cnd_wait(&w->wake, &w->lock);
        if (w->over)
            break;
        w->wanted--;
        w->running++;
        mtx_unlock(&w->lock);
        w->run(w->argument);
        mtx_lock(&w->lock);
        if (--w->running == 0)
            cnd_signal(&w->done);
    }
    mtx_unlock(&w->lock);
    return 0;
}

static bool make_locks(starg_workers *w) {
    if (mtx_init(&w->lock, mtx_plain) != thrd_success)
        return false;
    if (cnd_init(&w->wake) == thrd_success) {
        if (cnd_init(&w->done) == thrd_success)
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

starg_status workers_begin(starg_context *context, size_t most, void (*run)(void *argument),
                           void *argument, bool *begun) {
    starg_workers *w = workers_of(context);
    *begun = w != NULL && !atomic_exchange(&w->in_use, true);
    if (!*begun)
        return w == NULL ? STARG_ERROR_MEMORY : STARG_OK;
    while (w->count < most && w->count < w->room &&
           thrd_create(&w->threads[w->count], worker_main, w) == thrd_success)
        w->count++;
    mtx_lock(&w->lock);
    w->run = run;
    w->argument = argument;
    w->wanted = most < w->count ? most : w->count;
    for (size_t i = 0; i < w->wanted; i++)
        cnd_signal(&w->wake);
    mtx_unlock(&w->lock);
    return STARG_OK;
}

void workers_end(starg_context *context) {
    starg_workers *w = context->workers;
    mtx_lock(&w->lock);
    w->wanted = 0;
    while (w->running > 0)
        cnd_wait(&w->done, &w->lock);
    mtx_unlock(&w->lock);
    atomic_store(&w->in_use, false);
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
        cnd_destroy(&w->done);
        cnd_destroy(&w->wake);
        mtx_destroy(&w->lock);
    }
    context->allocator.release(context->allocator.user, w);
}
