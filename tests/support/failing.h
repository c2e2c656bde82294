/* SPDX-License-Identifier: Apache-2.0 */
/* Calls whose memory fails: the n-th allocation of the context, for every n until the call no
 * longer gets that far. Each attempt has a context of its own, which must be left without a block,
 * and a folder for outputs, which a call that fails must leave empty.
 *
 * Outside of this: what libraries allocate on their own (CBC, SQLite, jansson, ARPACK, AMD, zlib)
 * and the C library (streams, threads), since it does not come from the context.
 * tests/cli/test_limits.py limits the memory of whole processes for that. */
#ifndef TESTS_FAILING_H
#define TESTS_FAILING_H

#include <stdbool.h>
#include <stddef.h>

#include "starguard/context.h"
#include "support.h"

/* A test's calls, a line each by the macros below: makes the one whose turn it is, with the
 * context's memory failing, frees what came of it and returns its status; STARG_OK behind the last.
 */
typedef starg_status failing_calls(starg_context *context);

/* Runs every call so that each allocation fails once, alone and with all that follow it, on one
 * thread and on two, and prints how many that were. */
void failing_run(failing_calls *calls);

/* The same for calls that need the program TetGen: skips them where the first cannot be made. */
void failing_run_with_tetgen(failing_calls *calls);

/* Is it this call's turn? */
bool failing_turn(const char *name, const char *variant);

/* A call of the public function NAME, by EXPRESSION; tests/docs/test_allocation_table.py looks for
 * the names. VARIANT says which of its ways, and is empty if it has one. */
#define FAILING_BY(NAME, VARIANT, EXPRESSION)                                                      \
    do                                                                                             \
        if (failing_turn(#NAME, VARIANT))                                                          \
            return EXPRESSION;                                                                     \
    while (0)

/* NAME(context, ...) */
#define FAILING(NAME, VARIANT, ...) FAILING_BY(NAME, VARIANT, NAME(context, __VA_ARGS__))

/* NAME(context, ..., &out), which makes a TYPE that FREE frees. */
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

/* Between these two a call may prepare something with the same context: memory does not fail. */
void failing_pause(void);
void failing_resume(void);

/* A name in the folder for outputs; valid until the next call of it. */
const char *failing_output(const char *name);

/* Asserts that there is an object exactly if the status is STARG_OK, which it returns. */
starg_status failing_result(starg_status status, const void *object);

#endif
