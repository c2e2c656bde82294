/* SPDX-License-Identifier: Apache-2.0 */
#include "network.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "starguard/database.h"

static struct timespec after(double seconds) {
    struct timespec when;
    timespec_get(&when, TIME_UTC);
    long long nanoseconds = when.tv_nsec + (long long)(seconds * 1e9);
    when.tv_sec += (time_t)(nanoseconds / 1000000000);
    when.tv_nsec = (long)(nanoseconds % 1000000000);
    return when;
}

static bool send_message(void *user, int to, const void *bytes, size_t size) {
    const network_end *self = user;
    network *net = self->net;
    network_message *message = malloc(sizeof *message + size);
    size_t lost = self->ranks.rank > 0 && size > 0 && atomic_load(&net->garbles);
    *message = (network_message){.from = self->ranks.rank, .to = to, .size = size - lost};
    memcpy(message->bytes, bytes, size);
    mtx_lock(&net->lock);
    net->broken = net->broken || net->messages_left == 0;
    bool sent = !net->broken;
    if (sent) {
        network_message **last = &net->first;
        while (*last != NULL)
            last = &(*last)->next;
        *last = message;
        net->messages_left -= net->messages_left > 0;
    } else {
        free(message);
    }
    cnd_broadcast(&net->changed);
    mtx_unlock(&net->lock);
    return sent;
}

/* The first message to `to` from `from`, -1: from any sender. */
static network_message **find(network *net, int to, int from) {
    network_message **place = &net->first;
    while (*place != NULL && !((*place)->to == to && (from < 0 || (*place)->from == from)))
        place = &(*place)->next;
    return place;
}

static bool wait_for_message(void *user, double seconds, int *from, size_t *size) {
    network_end *self = user;
    network *net = self->net;
    struct timespec until = after(seconds);
    mtx_lock(&net->lock);
    while (*find(net, self->ranks.rank, -1) == NULL && !net->broken &&
           cnd_timedwait(&net->changed, &net->lock, &until) == thrd_success) {
    }
    const network_message *message = *find(net, self->ranks.rank, -1);
    bool sound = !net->broken;
    *from = message != NULL ? message->from : -1;
    *size = message != NULL ? message->size : 0;
    mtx_unlock(&net->lock);
    return sound;
}

static bool receive_message(void *user, int from, void *bytes, size_t size) {
    network_end *self = user;
    network *net = self->net;
    mtx_lock(&net->lock);
    network_message **place = find(net, self->ranks.rank, from), *message = *place;
    bool fits = message != NULL && message->size == size;
    if (fits) {
        *place = message->next;
        memcpy(bytes, message->bytes, size);
        free(message);
    }
    mtx_unlock(&net->lock);
    return fits;
}

static void break_way(network *net) {
    mtx_lock(&net->lock);
    net->broken = true;
    cnd_broadcast(&net->changed);
    mtx_unlock(&net->lock);
}

/* A helper that cannot continue ends the run, as a launcher would. */
static int serve(void *user) {
    network_end *self = user;
    if (starg_database_ranks_serve(self->context, &self->ranks) != STARG_OK)
        break_way(self->net);
    return 0;
}

/* Fails once, when *left reaches 0. */
static void *allocate_but_once(void *user, size_t size) {
    size_t *left = user;
    return *left > 0 && --*left == 0 ? NULL : malloc(size);
}

static void release(void *user, void *block) {
    (void)user;
    free(block);
}

static starg_context *failing_context(size_t *left) {
    starg_context_options options;
    starg_context *context = NULL;
    starg_context_options_default(&options);
    options.threads = 1;
    options.allocator = (starg_allocator){allocate_but_once, release, left};
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    return context;
}

static void begin(network *net, int count, int threads, size_t *left) {
    *net = (network){.count = count, .messages_left = -1};
    assert_int_equal(mtx_init(&net->lock, mtx_plain), thrd_success);
    assert_int_equal(cnd_init(&net->changed), thrd_success);
    for (int i = 0; i < count; i++) {
        network_end *end = &net->ends[i];
        *end = (network_end){.net = net};
        end->ranks = (starg_ranks){i, count, send_message, wait_for_message, receive_message, end};
        if (i == 0)
            continue;
        end->context = i == 1 && left != NULL ? failing_context(left) : test_context(threads);
        assert_int_equal(thrd_create(&end->thread, serve, end), thrd_success);
    }
}

void network_begin(network *net, int count, int threads) {
    begin(net, count, threads, NULL);
}

void network_begin_failing(network *net, int count, size_t *left) {
    begin(net, count, 1, left);
}

const starg_ranks *network_ranks(network *net) {
    return &net->ends[0].ranks;
}

bool network_end_all(network *net) {
    starg_context *context = test_context(1);
    bool sound = starg_ranks_release(context, network_ranks(net)) == STARG_OK;
    if (!sound)
        break_way(net);
    test_context_free(context);
    for (int i = 1; i < net->count; i++) {
        thrd_join(net->ends[i].thread, NULL);
        test_context_free(net->ends[i].context);
    }
    while (net->first != NULL) {
        network_message *message = net->first;
        net->first = message->next;
        free(message);
    }
    cnd_destroy(&net->changed);
    mtx_destroy(&net->lock);
    return sound;
}
