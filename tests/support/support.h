/* SPDX-License-Identifier: Apache-2.0 */
/* Common parts of the tests: cmocka in its required order, a context, shared data, random
 * numbers. */
#ifndef TESTS_SUPPORT_H
#define TESTS_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka requires these first */
#include <cmocka.h>

#include "starguard/context.h"
#include "starguard/mesh.h"

/* A context with the given number of threads; the test fails if it cannot be made. */
starg_context *test_context(int threads);

/* Same with memory that fails after *left more blocks. */
starg_context *test_scarce_context(int threads, size_t *left);

/* A starg_progress_fn that cancels everything. */
bool test_refuse(void *user, const char *stage, double fraction);

/* Frees a context; fails the test if a block of it is still in use or a stage has not ended. */
void test_context_free(starg_context *context);

/* Folder of the shared data; NULL with a printed reason if it is missing (the caller then calls
 * skip() and returns). */
const char *test_shared_data(void);

/* Number of rounds of a randomized test: a third of `usual`, or the percentage of `thorough` given
 * by STARGUARD_LONG in the environment (100 in make check-long), at least `usual`. Without it,
 * sanitizers, which make everything some five times as slow, get a sixth. */
size_t test_rounds(size_t usual, size_t thorough);

/* A size of a model, or an amount of work: `thorough` with STARGUARD_LONG, else `usual`, however
 * the program is built. */
size_t test_size(size_t usual, size_t thorough);

/* Step through a family of models: 1 with STARGUARD_LONG, else 5. */
size_t test_step(void);

/* Asserts that a status is STARG_OK; prints the context's message otherwise. */
void test_ok(starg_context *context, starg_status status);

#endif
