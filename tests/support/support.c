/* SPDX-License-Identifier: Apache-2.0 */
#include "support.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "core/context.h"

starg_context *test_context(int threads) {
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = threads;
    starg_context *context = NULL;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    return context;
}

static void *allocate_scarce(void *user, size_t size) {
    size_t *left = user;
    return *left == 0 ? NULL : (--*left, malloc(size));
}

static void release_scarce(void *user, void *block) {
    (void)user;
    free(block);
}

starg_context *test_scarce_context(int threads, size_t *left) {
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = threads;
    options.allocator = (starg_allocator){allocate_scarce, release_scarce, left};
    starg_context *context = NULL;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    return context;
}

bool test_refuse(void *user, const char *stage, double fraction) {
    (void)user, (void)stage, (void)fraction;
    return false;
}

void test_context_free(starg_context *context) {
    assert_int_equal(context->progress.depth, 0);
    assert_int_equal(starg_context_live_blocks(context), 0);
    starg_context_free(context);
}

const char *test_shared_data(void) {
    static char path[4096];
    const char *shared = getenv("STARGUARD_SHARED");
    struct stat info;
    snprintf(path, sizeof path, "%s/data", shared ? shared : "../shared");
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
        return path;
    printf("skipped: there is no shared data at %s\n", path);
    return NULL;
}

#ifdef __SANITIZE_ADDRESS__
enum { SHARE = 6 };
#else
enum { SHARE = 3 };
#endif

size_t test_rounds(size_t usual, size_t thorough) {
    const char *percent = getenv("STARGUARD_LONG");
    if (percent == NULL)
        return (usual + SHARE - 1) / SHARE;
    size_t rounds = thorough * strtoul(percent, NULL, 10) / 100;
    return rounds > usual ? rounds : usual;
}

size_t test_size(size_t usual, size_t thorough) {
    return getenv("STARGUARD_LONG") == NULL ? usual : thorough;
}

size_t test_step(void) {
    return getenv("STARGUARD_LONG") == NULL ? 5 : 1;
}

void test_ok(starg_context *context, starg_status status) {
    if (status != STARG_OK)
        print_error("%s\n", starg_context_error(context)->message);
    assert_int_equal(status, STARG_OK);
}
