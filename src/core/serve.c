/* SPDX-License-Identifier: Apache-2.0 */
/* Main loop of a helper: receives jobs, computes their blocks and replies, until END
 * (core/parallel.h). Each kind of work has a table of functions in its own folder and shares its
 * code with runs without helpers. */
#include "core/parallel.h"

static const double PATIENCE = 0.05; /* seconds between checks for cancellation */

typedef struct helper {
    starg_context *context;
    const starg_ranks *ranks;
    const ranks_work *const *works;
    const ranks_work *work; /* of the current job, NULL before the first */
    void *states[RANKS_WORKS];
    void **state;       /* of the current job */
    starg_status begun; /* status of its `begin` */
    uint64_t loop;
    bool released;
} helper;

static void end_jobs(helper *h) {
    for (int i = 0; i < RANKS_WORKS; i++)
        if (h->works[i] != NULL)
            h->works[i]->end(h->context, h->states[i]);
}

static void begin_job(helper *h, const ranks_message *head, starg_bytes_reader *rest) {
    h->work = NULL;
    h->loop = head->loop;
    h->begun = STARG_ERROR_RANK;
    if (head->work >= RANKS_WORKS || h->works[head->work] == NULL)
        return;
    h->context->seed = head->seed;
    starg_context_set_time_limit(h->context, head->seconds);
    h->work = h->works[head->work];
    h->state = &h->states[head->work];
    h->begun = h->work->begin(h->context, rest, h->state);
}

static starg_status work_on_block(helper *h, const ranks_message *head) {
    starg_status status = h->begun;
    ranks_message answer = *head;
    starg_bytes reply = {0};
    if (head->loop != h->loop || h->work == NULL)
        status = STARG_ERROR_RANK;
    if (status == STARG_OK)
        status = h->work->run(h->context, *h->state, head->first, head->count, &reply);
    answer.kind = RANKS_REPLY;
    answer.status = status;
    if (status != STARG_ERROR_CANCELLED)
        status = ranks_send(h->context, h->ranks, 0, &answer, reply.data, reply.count);
    STARG_ARRAY_FREE(h->context, &reply);
    return status;
}

static starg_status release_helper(helper *h, const ranks_message *head) {
    h->released = true;
    if (head->kind != RANKS_END)
        return STARG_ERROR_RANK;
    return ranks_send(h->context, h->ranks, 0, head, NULL, 0);
}

static starg_status take_message(helper *h) {
    SCOPED void *bytes = NULL;
    int from;
    ranks_message head;
    starg_bytes_reader rest;
    TRY(ranks_receive(h->context, h->ranks, PATIENCE, &from, &head, &rest, &bytes));
    if (bytes == NULL)
        return STARG_OK;
    if (head.kind == RANKS_BLOCK)
        return work_on_block(h, &head);
    if (head.kind != RANKS_JOB)
        return release_helper(h, &head);
    begin_job(h, &head, &rest);
    return STARG_OK;
}

starg_status ranks_serve(starg_context *context, const starg_ranks *ranks,
                         const ranks_work *const works[RANKS_WORKS]) {
    starg_status status = STARG_OK;
    helper h = {.context = context, .ranks = ranks, .works = works};
    while (!h.released) {
        STARG_TRY(starg_check_cancel(context, "ranks"));
        STARG_TRY(take_message(&h));
    }
done:
    end_jobs(&h);
    return status;
}
