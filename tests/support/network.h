/* SPDX-License-Identifier: Apache-2.0 */
/* Processes that share work, as threads of the test: rank 0 is the test itself, the helpers serve
 * on threads with contexts of their own, and messages go through queues. */
#ifndef TESTS_NETWORK_H
#define TESTS_NETWORK_H

#include <stdatomic.h>
#include <threads.h>

#include "starguard/ranks.h"
#include "support.h"

enum { NETWORK_MOST = 8 };

typedef struct network_message {
    struct network_message *next;
    int from, to;
    size_t size;
    unsigned char bytes[];
} network_message;

typedef struct network network;

typedef struct network_end {
    network *net;
    starg_ranks ranks;
    starg_context *context; /* of a helper */
    thrd_t thread;
} network_end;

struct network {
    mtx_t lock;
    cnd_t changed;
    network_message *first;
    bool broken;         /* every function says so from now on */
    long messages_left;  /* before it breaks; below 0: any number */
    atomic_bool garbles; /* replies lose their last byte */
    network_end ends[NETWORK_MOST];
    int count;
};

/* Starts count - 1 helpers with some threads each. */
void network_begin(network *net, int count, int threads);

/* The same, but the *left-th allocation of one helper, rank 1, fails. */
void network_begin_failing(network *net, int count, size_t *left);

/* What rank 0 gives to starg_context_set_ranks. */
const starg_ranks *network_ranks(network *net);

/* Sends the helpers home or, if that cannot be, breaks the way to them; waits for them, and asserts
 * that they have no memory left. */
void network_end_all(network *net);

#endif
