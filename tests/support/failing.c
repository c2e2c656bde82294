/* SPDX-License-Identifier: Apache-2.0 */
#include "failing.h"

#include <dirent.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "core/context.h"
#include "core/rng.h"

/* ---- memory ---- */

/* Precedes every block, to count bytes. */
typedef union head {
    size_t size;
    max_align_t align;
} head;

/* Memory of one attempt. `asked` counts allocations while armed. */
static struct {
    bool armed;
    bool for_good; /* all later allocations fail as well */
    size_t failing;
    atomic_size_t asked, failed, blocks, bytes;
} memory;

static bool must_fail(void) {
    if (!memory.armed)
        return false;
    size_t number = atomic_fetch_add(&memory.asked, 1) + 1;
    bool fails = number == memory.failing || (memory.for_good && number > memory.failing);
    if (fails)
        atomic_fetch_add(&memory.failed, 1);
    return fails;
}

static void *allocate(void *user, size_t size) {
    (void)user;
    head *block = must_fail() ? NULL : malloc(sizeof *block + size);
    if (block == NULL)
        return NULL;
    block->size = size;
    atomic_fetch_add(&memory.blocks, 1);
    atomic_fetch_add(&memory.bytes, size);
    return block + 1;
}

static void release(void *user, void *block) {
    (void)user;
    head *start = (head *)block - 1;
    atomic_fetch_sub(&memory.blocks, 1);
    atomic_fetch_sub(&memory.bytes, start->size);
    free(start);
}

void failing_pause(void) {
    memory.armed = false;
}

void failing_resume(void) {
    memory.armed = true;
}

/* ---- outputs ---- */

static char folder[] = "/tmp/failing-XXXXXX";
static bool folder_made;

const char *failing_output(const char *name) {
    static char path[128];
    if (!folder_made)
        assert_non_null(mkdtemp(folder));
    folder_made = true;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* Removes the files in the folder; returns their number. */
static size_t clear_folder(void) {
    size_t count = 0;
    if (!folder_made)
        return 0;
    DIR *list = opendir(folder);
    assert_non_null(list);
    for (struct dirent *entry; (entry = readdir(list)) != NULL;)
        if (entry->d_name[0] != '.' && unlinkat(dirfd(list), entry->d_name, 0) == 0)
            count++;
    closedir(list);
    return count;
}

static void remove_folder(void) {
    if (folder_made)
        rmdir(folder);
    folder_made = false;
    memcpy(folder + sizeof folder - 7, "XXXXXX", 6);
}

starg_status failing_result(starg_status status, const void *object) {
    assert_true((status == STARG_OK) == (object != NULL));
    return status;
}

/* ---- turns ---- */

/* The call under test: the `wanted`-th of those that ask for their turn. */
static struct {
    failing_calls *calls;
    size_t wanted, asked;
    const char *name, *variant; /* NULL after the last */
} turn;

bool failing_turn(const char *name, const char *variant) {
    if (turn.asked++ != turn.wanted)
        return false;
    turn.name = name;
    turn.variant = variant;
    return true;
}

static void begin_turn(failing_calls *calls, size_t wanted) {
    turn.calls = calls;
    turn.wanted = wanted;
}

static starg_status make_call(starg_context *context) {
    turn.asked = 0;
    turn.name = NULL;
    return turn.calls(context);
}

/* ---- attempts ---- */

enum { LEAST = 10, MOST = 2000 }; /* n that are tried one by one */

/* How a table is processed. */
typedef struct run_mode {
    int threads;
    bool for_good;
    double seconds, thorough; /* processor time for the first n; thorough 0: for every n */
} run_mode;

static const run_mode RUN_MODES[] = {
    {1, false, 0.12, 0}, {1, true, 0.025, 4}, {2, false, 0.025, 4}};

typedef struct tally {
    size_t allocations, attempts, failed;
} tally;

static void report_failure(const run_mode *how, size_t n, const char *what) {
    print_error("%s (%s), %d threads, allocation %zu%s: %s\n", turn.name, turn.variant,
                how->threads, n, how->for_good ? " and all later ones" : "", what);
    fail();
}

static void check_failure(const run_mode *how, size_t n, const starg_context *context,
                          starg_status status) {
    const starg_error *error = starg_context_error(context);
    if (status != STARG_ERROR_MEMORY) {
        print_error("status %d: %s\n", (int)status, error->message);
        report_failure(how, n, "not the status for memory");
    }
    if (error->status != STARG_ERROR_MEMORY || error->message[0] == '\0' || error->stage[0] == '\0')
        report_failure(how, n, "no message about memory");
}

/* Makes the n-th allocation fail; false if the call succeeded with fewer. */
static bool attempt(const run_mode *how, size_t n, tally *sum) {
    starg_context_options options;
    starg_context *context = NULL;
    starg_context_options_default(&options);
    options.threads = how->threads;
    options.allocator = (starg_allocator){allocate, release, NULL};
    memory.failing = n;
    memory.for_good = how->for_good;
    atomic_store(&memory.asked, 0);
    atomic_store(&memory.failed, 0);
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);

    failing_resume();
    starg_status status = make_call(context);
    failing_pause();
    bool reached = atomic_load(&memory.failed) > 0;
    size_t left = starg_context_live_blocks(context);
    if (context->progress.depth != 0)
        report_failure(how, n, "a stage has not ended");
    sum->allocations = atomic_load(&memory.asked);
    sum->attempts++;
    sum->failed += status != STARG_OK;

    if (status != STARG_OK && !reached)
        test_ok(context, status);
    if (status != STARG_OK)
        check_failure(how, n, context, status);
    else if (reached)
        report_failure(how, n, "success although memory has failed");
    starg_context_free(context);
    if (left != 0 || atomic_load(&memory.blocks) != 0 || atomic_load(&memory.bytes) != 0)
        report_failure(how, n, "memory is still in use");
    if (clear_folder() != 0 && status != STARG_OK)
        report_failure(how, n, "an output was left behind");
    return reached;
}

/* Measurements of a call without failures. */
typedef struct extent {
    size_t allocations;
    double seconds; /* of processor time */
} extent;

static extent measure(void) {
    tally sum = {0};
    clock_t began = clock();
    attempt(&RUN_MODES[0], SIZE_MAX, &sum);
    return (extent){sum.allocations, (double)(clock() - began) / CLOCKS_PER_SEC};
}

/* Number of n that are tried one by one, given the time. */
static size_t choose_limit(double seconds, const extent *whole) {
    double limit = whole->seconds > 0 ? seconds / whole->seconds : MOST;
    return limit < LEAST ? LEAST : limit < MOST ? (size_t)limit : MOST;
}

static void tell(const run_mode *how, const tally *sum) {
    printf("%-34s %-24s %7d %-6s %11zu %8zu %8zu\n", turn.name, turn.variant, how->threads,
           how->for_good ? "all" : "one", sum->allocations, sum->attempts, sum->failed);
}

/* Every n, until the call succeeds with fewer allocations. */
static void try_all(const run_mode *how) {
    tally sum = {0};
    for (size_t n = 1; attempt(how, n, &sum);)
        n++;
    tell(how, &sum);
}

/* All n up to a limit, then about a quarter as many, evenly spaced from a random start. */
static void try_some(const run_mode *how, double seconds, const extent *whole) {
    tally sum = {0};
    size_t limit = choose_limit(seconds, whole), last = whole->allocations, stride = 1;
    starg_rng rng = starg_rng_make(1, limit, last);
    if (last > limit)
        stride = 1 + (last - limit) / (limit / 4 + 1);
    for (size_t n = 1; n <= last; n += n < limit ? 1 : stride) {
        if (n == limit)
            n += starg_rng_below(&rng, stride);
        attempt(how, n, &sum);
    }
    sum.allocations = last;
    tell(how, &sum);
}

/* STARGUARD_LONG=1 (make check-long): every n. Blocks lost by earlier tests are not counted. */
void failing_run(failing_calls *calls) {
    const char *asked = getenv("STARGUARD_LONG");
    bool thorough = asked != NULL && strcmp(asked, "1") == 0;
    atomic_store(&memory.blocks, 0);
    atomic_store(&memory.bytes, 0);
    printf("%-34s %-24s %7s %-6s %11s %8s %8s\n", "call", "", "threads", "fails", "allocations",
           "attempts", "failed");
    for (size_t i = 0;; i++) {
        begin_turn(calls, i);
        extent once = measure();
        if (turn.name == NULL)
            break;
        for (size_t m = 0; m < sizeof RUN_MODES / sizeof *RUN_MODES; m++) {
            double seconds = thorough ? RUN_MODES[m].thorough : RUN_MODES[m].seconds;
            if (seconds == 0)
                try_all(&RUN_MODES[m]);
            else
                try_some(&RUN_MODES[m], seconds, &once);
        }
    }
    remove_folder();
}

void failing_run_with_tetgen(failing_calls *calls) {
    starg_context *context = test_context(1);
    begin_turn(calls, 0);
    starg_status status = make_call(context);
    bool missing = status == STARG_ERROR_SOLVER;
    if (missing)
        printf("skipped: %s\n", starg_context_error(context)->message);
    else
        test_ok(context, status);
    test_context_free(context);
    if (missing)
        skip();
    failing_run(calls);
}
