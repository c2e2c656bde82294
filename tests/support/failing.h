/* SPDX-License-Identifier: Apache-2.0 */
/* Calls with failing memory: the n-th allocation of the context fails, for every n until the call
 * no longer gets that far. Each attempt has its own context, which must end without blocks, and an
 * output folder, which a failing call must leave empty.
 *
 * Not covered: allocations by libraries (CBC, SQLite, jansson, Eigen, AMD, zlib) and by the C
 * library (streams, threads), which bypass the context. For those, tests/cli/test_limits.py limits
 * the memory of whole processes. */
#ifndef TESTS_FAILING_H
#define TESTS_FAILING_H

#include <stdbool.h>
#include <stddef.h>

#include "starguard/context.h"
#include "support.h"

/* A test's calls, one line each by the macros below: makes the call whose turn it is, with the
 * context's memory failing, frees the results and returns its status; STARG_OK after the last. */
typedef starg_status failing_calls(starg_context *context);

/* Runs every call so that each allocation fails once, alone and with all later ones, on one and on
 * two threads, and prints how many there were. */
void failing_run(failing_calls *calls);

/* Same for calls that need the program TetGen: skips them if the first one cannot be made. */
void failing_run_with_tetgen(failing_calls *calls);

/* Is it this call's turn? */
bool failing_turn(const char *name, const char *variant);

/* A call of the public function NAME, by EXPRESSION; tests/docs/test_allocation_table.py looks for
 * the names. VARIANT distinguishes several calls of one function, or is empty. */
#define FAILING_BY(NAME, VARIANT, EXPRESSION)                                                      \
    do                                                                                             \
        if (failing_turn(#NAME, VARIANT))                                                          \
            return EXPRESSION;                                                                     \
    while (0)

/* NAME(context, ...) */
#define FAILING(NAME, VARIANT, ...) FAILING_BY(NAME, VARIANT, NAME(context, __VA_ARGS__))

/* NAME(context, ..., &out), which makes a TYPE freed by FREE. */
#define FAILING_MAKES(NAME, VARIANT, TYPE, FREE, ...)                                              \
    do                                                                                             \
        if (failing_turn(#NAME, VARIANT)) {                                                        \
            TYPE *out = NULL;                                                                      \
            starg_status status = NAME(context, __VA_ARGS__, &out);                                \
            failing_result(status, out);                                                           \
            FREE;                                                                                  \
            return status;                                                                         \
        }                                                                                          \
    while (0)

/* NAME(context, ..., &text, &size) */
#define FAILING_TEXT(NAME, VARIANT, ...)                                                           \
    do                                                                                             \
        if (failing_turn(#NAME, VARIANT)) {                                                        \
            char *text = NULL;                                                                     \
            size_t size;                                                                           \
            starg_status status = NAME(context, __VA_ARGS__, &text, &size);                        \
            failing_result(status, text);                                                          \
            starg_text_free(context, text);                                                        \
            return status;                                                                         \
        }                                                                                          \
    while (0)

#define FAILING_TEST(CALLS)                                                                        \
    static void test_##CALLS(void **state) {                                                       \
        (void)state;                                                                               \
        failing_run(CALLS);                                                                        \
    }

/* Between these two a call can prepare data with the same context: memory does not fail. */
void failing_pause(void);
void failing_resume(void);

/* A file name in the output folder; valid until the next call. */
const char *failing_output(const char *name);

/* Asserts that there is an object exactly if the status is STARG_OK, and returns the status. */
starg_status failing_result(starg_status status, const void *object);

#endif
