/* SPDX-License-Identifier: Apache-2.0 */
/* What the tests share: cmocka in its required order, a context, shared data, random numbers. */
#ifndef TESTS_SUPPORT_H
#define TESTS_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants these before it */
#include <cmocka.h>

#include "starguard/context.h"
#include "starguard/mesh.h"

/* A context with the given number of threads; the test fails if it cannot be made. */
starg_context *test_context(int threads);

/* The same with memory that gives out after *left more blocks. */
starg_context *test_scarce_context(int threads, size_t *left);

/* A starg_progress_fn that wants everything cancelled. */
bool test_refuse(void *user, const char *stage, double fraction);

/* Frees a context and fails the test if any block of it is still in use, or any stage has not
 * ended. */
void test_context_free(starg_context *context);

/* Folder of the shared data, or NULL with a printed reason when it is not there (then the caller
 * returns, after skip()). */
const char *test_shared_data(void);

/* How often a test of random cases is to try: `usual`, or as many percent of `thorough` as
 * STARGUARD_LONG in the environment says (100 in make check-long). */
size_t test_rounds(size_t usual, size_t thorough);

/* Asserts that a status is STARG_OK, and prints the context's message when it is not. */
void test_ok(starg_context *context, starg_status status);

#endif
