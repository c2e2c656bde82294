/* Calls whose memory fails: the n-th allocation of the context, for every n until the call no
 * longer gets that far. Each attempt has a context of its own, which must be left without a block,
 * and a folder for outputs, which a call that fails must leave empty.
 *
 * Outside of this: what libraries allocate on their own (CBC, SQLite, jansson, ARPACK, AMD, zlib)
 * and the C library (streams, threads), since it does not come from the context.
 * tests/cli/test_limits.py limits the memory of whole processes for that. */
#ifndef TESTS_FAILING_H
#define TESTS_FAILING_H

#include <stddef.h>

#include "starguard/context.h"
#include "support.h"

/* A call with its input. `run` makes the call with the context's memory failing, frees what came of
 * it and returns its status. */
typedef struct failing_call {
    const char *name;    /* the public function: tests/docs/test_allocation_table.py looks for it */
    const char *variant; /* which of its ways; "" if it has one */
    starg_status (*run)(starg_context *context);
    const char
        *fallback; /* why the call may succeed although memory has failed; NULL: it may not */
} failing_call;

/* Runs every call of a table so that each allocation fails once, alone and with all that follow it,
 * on one thread and on two, and prints how many that were. */
void failing_run(const failing_call *calls, size_t count);

/* Between these two a call may prepare something with the same context: memory does not fail. */
void failing_pause(void);
void failing_resume(void);

/* A name in the folder for outputs; valid until the next call of it. */
const char *failing_output(const char *name);

/* Asserts that there is an object exactly if the status is STARG_OK, which it returns. */
starg_status failing_result(starg_status status, const void *object);

#define FAILING_RUN(CALLS) failing_run((CALLS), sizeof(CALLS) / sizeof *(CALLS))

#endif
