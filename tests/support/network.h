/* SPDX-License-Identifier: Apache-2.0 */
/* Processes that share work, simulated by threads: rank 0 is the test itself, helpers serve on
 * threads with their own contexts, and messages go through queues. */
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
    bool broken;         /* every function fails from now on */
    long messages_left;  /* messages until it breaks; negative: unlimited */
    atomic_bool garbles; /* replies lose their last byte */
    network_end ends[NETWORK_MOST];
    int count;
};

/* Starts count - 1 helpers with several threads each. */
void network_begin(network *net, int count, int threads);

/* Same, but the *left-th allocation of one helper, rank 1, fails. */
void network_begin_failing(network *net, int count, size_t *left);

/* Rank 0's argument for starg_context_set_ranks. */
const starg_ranks *network_ranks(network *net);

/* Releases the helpers or, if that fails, breaks the connections; waits for them, and asserts that
 * they have no memory left. Whether the release succeeded. */
bool network_end_all(network *net);

#endif
