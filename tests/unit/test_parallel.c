/* SPDX-License-Identifier: Apache-2.0 */
/* Parallel loops: every item runs once, whatever the number of threads, one loop after another,
 * within another, whose threads it shares, and in a child process. */
#include <stdatomic.h>
#include <stdio.h>
#include <sys/wait.h>
#include <threads.h>
#include <unistd.h>

#include "core/parallel.h"
#include "support.h"

enum { ITEMS = 300, LOOPS = 3000, FAILS = 7 };

typedef struct tally {
    atomic_int runs[ITEMS];
    size_t inner; /* items of a loop within each item */
    int fails;    /* every FAILS-th item */
} tally;

static starg_status add(starg_context *context, void *shared, void *scratch, size_t item);

static starg_status run(starg_context *context, tally *t, size_t count) {
    const starg_parallel_loop loop = {
        .stage = "test", .count = count, .shared = t, .item = add, .silent = true};
    return starg_parallel_for(context, &loop);
}

static starg_status add(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)scratch;
    tally *t = shared;
    atomic_fetch_add(&t->runs[item], 1);
    if (t->inner > 0) {
        tally within = {0};
        starg_status status = run(context, &within, t->inner);
        for (size_t i = 0; status == STARG_OK && i < ITEMS; i++)
            if (atomic_load(&within.runs[i]) != (i < t->inner))
                return STARG_ERROR_SOLVER;
        return status;
    }
    return t->fails && item % FAILS == FAILS - 1 ? STARG_ERROR_RANGE : STARG_OK;
}

/* True if each of the first `count` items ran `times` times and no other did. */
static bool ran(const tally *t, size_t count, int times) {
    for (size_t i = 0; i < ITEMS; i++)
        if (atomic_load(&t->runs[i]) != (i < count ? times : 0))
            return false;
    return true;
}

static void test_many_loops(void **state) {
    (void)state;
    for (int threads = 1; threads <= 5; threads += 2) {
        starg_context *context = test_context(threads);
        for (size_t count = 0; count <= ITEMS; count += count < 8 ? 1 : 97) {
            tally t = {0};
            for (int i = 0; i < LOOPS / 10; i++)
                test_ok(context, run(context, &t, count));
            assert_true(ran(&t, count, LOOPS / 10));
        }
        test_context_free(context);
    }
}

static void test_loop_within(void **state) {
    (void)state;
    starg_context *context = test_context(4);
    tally t = {.inner = 50};
    test_ok(context, run(context, &t, ITEMS));
    assert_true(ran(&t, ITEMS, 1));
    test_context_free(context);
}

static void test_failure(void **state) {
    (void)state;
    starg_context *context = test_context(4);
    for (int i = 0; i < LOOPS; i++) {
        tally t = {.fails = 1};
        assert_int_equal(run(context, &t, ITEMS), STARG_ERROR_RANGE);
        assert_true(atomic_load(&t.runs[FAILS - 1]) == 1);
        tally later = {0};
        test_ok(context, run(context, &later, 3));
        assert_true(ran(&later, 3, 1));
    }
    test_context_free(context);
}

/* Ends when two threads run it. */
static starg_status meet(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)context, (void)scratch;
    tally *t = shared;
    atomic_store(&t->runs[item], 1);
    while (atomic_load(&t->runs[1 - item]) == 0)
        thrd_yield();
    return STARG_OK;
}

static bool two_work(starg_context *context) {
    tally t = {0};
    const starg_parallel_loop loop = {
        .stage = "test", .count = 2, .shared = &t, .item = meet, .silent = true};
    return starg_parallel_for(context, &loop) == STARG_OK && ran(&t, 2, 1);
}

/* Of an outer loop with two items: the first one has a loop that ends when two threads run it, the
 * second one has nothing to do. */
static starg_status meet_within(starg_context *context, void *shared, void *scratch, size_t item) {
    (void)shared, (void)scratch;
    return item == 1 || two_work(context) ? STARG_OK : STARG_ERROR_SOLVER;
}

static void test_loop_shared(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    const starg_parallel_loop loop = {
        .stage = "test", .count = 2, .item = meet_within, .silent = true};
    alarm(60);
    for (int i = 0; i < LOOPS / 10; i++)
        test_ok(context, starg_parallel_for(context, &loop));
    alarm(0);
    test_context_free(context);
}

typedef struct calls {
    thrd_t calling;
    atomic_int elsewhere;  /* reports on other threads than the calling one */
    atomic_int rule_fails; /* items that saw the time rule of another one */
    tally met;
} calls;

static bool note_thread(void *user, const char *stage, double fraction) {
    (void)stage, (void)fraction;
    calls *c = user;
    atomic_fetch_add(&c->elsewhere, !thrd_equal(thrd_current(), c->calling));
    return true;
}

/* Each item has a time rule of its own while both run, and may have stages. */
static starg_status enter_stage(starg_context *context, void *shared, void *scratch, size_t item) {
    calls *c = shared;
    const starg_time_rule own = item == 0 ? STARG_TIME_IGNORED : STARG_TIME_FAILS;
    const starg_time_rule former = starg_time_begin(context, own);
    starg_progress_begin(context, "item");
    meet(context, &c->met, scratch, item);
    starg_progress_step(context, 1, 2);
    atomic_fetch_add(&c->rule_fails, starg_time_rule_of(context) != own);
    starg_progress_end(context);
    starg_time_end(context, former);
    return STARG_OK;
}

static void test_items_apart(void **state) {
    (void)state;
    for (int i = 0; i < LOOPS / 10; i++) {
        calls c = {.calling = thrd_current()};
        const starg_context_options options = {
            .threads = 2, .progress = note_thread, .progress_user = &c};
        const starg_parallel_loop loop = {
            .stage = "test", .count = 2, .shared = &c, .item = enter_stage};
        starg_context *context;
        assert_int_equal(starg_context_create(&options, &context), STARG_OK);
        test_ok(context, starg_parallel_for(context, &loop));
        assert_int_equal(atomic_load(&c.elsewhere), 0);
        assert_int_equal(atomic_load(&c.rule_fails), 0);
        assert_int_equal(starg_time_rule_of(context), STARG_TIME_SHORTENS);
        test_context_free(context);
    }
}

/* Runs of three tasks, and how often what they made was undone. */
typedef struct errands {
    atomic_int made[3], undone[3];
    starg_status status[3];
} errands;

static starg_status run_errand(starg_context *context, void *shared, size_t task) {
    errands *e = shared;
    atomic_fetch_add(&e->made[task], 1);
    return e->status[task] == STARG_OK
               ? STARG_OK
               : starg_fail(context, e->status[task], "test", "task %zu", task);
}

static void undo_errand(void *shared, size_t task) {
    errands *e = shared;
    atomic_fetch_add(&e->undone[task], 1);
}

/* Status and detail are those of the first that fails. */
static void test_tasks(void **state) {
    (void)state;
    starg_context *context = test_context(3);
    for (int i = 0; i < LOOPS / 10; i++) {
        errands e = {.status = {STARG_OK, STARG_OK, STARG_OK}};
        const starg_tasks tasks = {
            .stage = "test", .count = 3, .shared = &e, .run = run_errand, .undo = undo_errand};
        test_ok(context, starg_run_tasks(context, &tasks));
        e.status[1] = STARG_ERROR_MESH;
        e.status[2] = STARG_ERROR_RANGE;
        assert_int_equal(starg_run_tasks(context, &tasks), STARG_ERROR_MESH);
        assert_string_equal(starg_context_error(context)->message, "task 1");
        for (int k = 0; k < 3; k++)
            assert_int_equal(e.made[k] - e.undone[k], 2);
    }
    test_context_free(context);
}

/* A child has no thread but the one that forked; it and its parent both go on. */
static void test_child(void **state) {
    (void)state;
    starg_context *context = test_context(3);
    assert_true(two_work(context));
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        alarm(60);
        bool right = two_work(context) && two_work(context);
        starg_context_free(context);
        _exit(right ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    assert_true(two_work(context));
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_many_loops),  cmocka_unit_test(test_loop_within),
        cmocka_unit_test(test_loop_shared), cmocka_unit_test(test_items_apart),
        cmocka_unit_test(test_tasks),       cmocka_unit_test(test_failure),
        cmocka_unit_test(test_child)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
