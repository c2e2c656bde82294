/* SPDX-License-Identifier: Apache-2.0 */
/* Distributed parallel loop: items are shared with other processes.
 *
 * The calling thread of rank 0 hands out blocks of items and collects replies; threads of this
 * process take single items from the same counter. Faster workers do more, and the result does not
 * depend on who computed an item. Blocks shrink towards the end (guided self-scheduling:
 * Polychronopoulos, Kuck 1987), so that all workers finish at nearly the same time. A helper holds
 * PREFETCH blocks: it works on the next one while a reply travels.
 *
 * The calling thread has no core of its own and sleeps between messages: it sees a message up to
 * PATIENCE seconds late, which prefetching hides.
 *
 * At the end no message is in flight: replies made useless by a failure are received and dropped,
 * so that no helper blocks on an answer while it gets the next job. They are left only when this
 * process is cancelled or cannot continue. */
#include <math.h>

#include "core/workers.h"

enum { PREFETCH = 2, SHARES = 4 };

static const double PATIENCE = 1e-3;

typedef struct distribution {
    worker_group *group;
    const starg_ranks *ranks;
    uint64_t number; /* of the loop */
    size_t under_way;
} distribution;

static starg_status send_jobs(const distribution *s) {
    starg_context *context = s->group->context;
    const starg_parallel_remote *remote = s->group->loop->remote;
    ranks_message head = {
        .kind = RANKS_JOB, .loop = s->number, .seed = context->seed, .work = remote->work};
    for (int to = 1; to < s->ranks->count; to++) {
        double left = starg_seconds_left(context);
        if (left < INFINITY) /* 0 means no limit */
            head.seconds = fmax(left, 1e-9);
        TRY(ranks_send(context, s->ranks, to, &head, remote->job->data, remote->job->count));
    }
    return STARG_OK;
}

/* Leaves SHARES blocks per process, within limits; at least one item per thread of the helper. */
static size_t block_size(const distribution *s) {
    const worker_group *group = s->group;
    size_t count = group->loop->count, taken = atomic_load(&group->next);
    size_t left = taken < count ? count - taken : 0;
    size_t size = left / ((size_t)s->ranks->count * SHARES),
           least = (size_t)group->context->threads;
    size_t most = group->loop->remote->most;
    size = most > 0 && size > most ? most : size;
    return size > least ? size : least;
}

static starg_status hand_out(distribution *s, int to) {
    worker_group *group = s->group;
    size_t size = block_size(s), first = atomic_fetch_add(&group->next, size);
    if (first >= group->loop->count || worker_group_must_stop(group, first))
        return STARG_OK;
    size_t left = group->loop->count - first;
    const ranks_message head = {
        .kind = RANKS_BLOCK, .loop = s->number, .first = first, .count = size < left ? size : left};
    TRY(ranks_send(group->context, s->ranks, to, &head, NULL, 0));
    s->under_way++;
    return STARG_OK;
}

static starg_status hand_out_first(distribution *s) {
    for (int i = 0; i < PREFETCH; i++)
        for (int to = 1; to < s->ranks->count; to++)
            TRY(hand_out(s, to));
    return STARG_OK;
}

static bool is_sound(const distribution *s, const ranks_message *head) {
    size_t count = s->group->loop->count;
    return head->kind == RANKS_REPLY && head->count <= count && head->first <= count - head->count;
}

/* A reply with ERROR_TIME may hold the items finished in time. */
static starg_status take_reply(distribution *s, const ranks_message *head,
                               starg_bytes_reader *rest) {
    worker_group *group = s->group;
    starg_status status = (starg_status)head->status;
    s->under_way--;
    if (status == STARG_OK || (status == STARG_ERROR_TIME && rest->left > 0)) {
        starg_status taken = group->loop->remote->take(group->context, group->loop->shared,
                                                       head->first, head->count, rest);
        if (taken != STARG_OK)
            return taken;
    }
    if (status != STARG_OK) {
        worker_group_fail(group, head->first, status);
        return STARG_OK;
    }
    group->context->helped_items += head->count;
    worker_group_finish(group, head->first, head->count);
    return STARG_OK;
}

/* Waits briefly for a reply; its sender gets the next block. */
static starg_status serve_one(distribution *s) {
    starg_context *context = s->group->context;
    SCOPED void *bytes = NULL;
    int from;
    ranks_message head;
    starg_bytes_reader rest;
    TRY(ranks_receive(context, s->ranks, PATIENCE, &from, &head, &rest, &bytes));
    if (bytes == NULL || head.loop != s->number)
        return STARG_OK;
    if (!is_sound(s, &head))
        return STARG_ERROR_RANK;
    TRY(take_reply(s, &head, &rest));
    return hand_out(s, from);
}

static bool is_over(const distribution *s) {
    const worker_group *group = s->group;
    if (atomic_load(&group->context->cancelled))
        return true;
    return s->under_way == 0 &&
           (atomic_load(&group->stop) || atomic_load(&group->finished) == group->loop->count);
}

void worker_group_distribute(worker_group *group) {
    starg_status status = STARG_OK;
    starg_context *context = group->context;
    distribution s = {.group = group, .ranks = context->ranks, .number = ++context->shared_loops};
    double began = starg_clock();
    STARG_TRY(send_jobs(&s));
    STARG_TRY(hand_out_first(&s));
    while (!is_over(&s)) {
        STARG_TRY(serve_one(&s));
        worker_group_report(group);
    }
    if (atomic_load(&group->finished) < group->loop->count) /* cancelled */
        worker_group_must_stop(group, group->loop->count);
done:
    context->shared_seconds += starg_clock() - began;
    if (status != STARG_OK)
        worker_group_fail(group, 0, status);
}
