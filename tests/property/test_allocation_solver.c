/* SPDX-License-Identifier: Apache-2.0 */
/* Memory failures of CBC and Clp: the n-th call of C++'s operator new fails, in a separate process
 * for each n. If memory is available again once the reserve is released, the returned cover is
 * valid with a valid bound, and there are no leaks. If memory never returns, the process ends with
 * status 3.
 *
 * The program defines its own operator new, which libraries find before theirs. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cover_oracle.h"
#include "support.h"

enum { OPTIMUM = 18 }; /* of cover_oracle_lines in three dimensions */

static size_t asked, failing; /* 0: none fails */
static bool for_good;         /* all later ones fail as well */

void *_Znwm(size_t size) __attribute__((visibility("default")));
void _ZdlPv(void *block) __attribute__((visibility("default")));
void _ZdlPvm(void *block, size_t size) __attribute__((visibility("default")));
void _ZSt17__throw_bad_allocv(void) __attribute__((noreturn));
void (*_ZSt15get_new_handlerv(void))(void);

/* operator new(unsigned long), as the C++ ABI calls it */
void *_Znwm(size_t size) {
    bool fails = ++asked == failing || (for_good && asked > failing);
    for (;; fails = fails && for_good) {
        void *block = fails ? NULL : malloc(size > 0 ? size : 1);
        void (*handler)(void) = _ZSt15get_new_handlerv(); /* std::get_new_handler() */
        if (block != NULL)
            return block;
        if (handler == NULL)
            _ZSt17__throw_bad_allocv(); /* std::__throw_bad_alloc() */
        handler();
    }
}

/* operator delete(void *), with and without the size */
void _ZdlPv(void *block) {
    free(block);
}

void _ZdlPvm(void *block, size_t size) {
    (void)size;
    free(block);
}

static bool is_cover(const starg_bits *bits, const starg_cover *cover) {
    for (size_t j = 0; j < starg_bits_columns(bits); j++) {
        bool held = false;
        for (size_t i = 0; i < cover->count; i++)
            held = held || starg_bits_test(bits, cover->rows[i], j);
        if (!held)
            return false;
    }
    return true;
}

/* Exit statuses of the failing process. */
enum {
    FINE = 0,
    NO_COVER = 1,
    WRONG_COVER = 2,
    WRONG_BOUND = 7,
    OUT_OF_MEMORY = 3, /* the library's own */
    LEAK = 4,
    HANDLER = 5,
    NOT_REACHED = 6
};

/* Solves, for some n twice; the n-th allocation fails the first time. */
static int solve(size_t n) {
    starg_context *context = test_context(1);
    starg_bits *bits = cover_oracle_lines(context, 3);
    starg_cover_problem problem;
    starg_cover_options options;
    starg_cover_problem_default(&problem);
    starg_cover_options_default(&options);
    problem.rows = bits;
    options.max_nodes = 3;
    int result = FINE;
    asked = 0;
    failing = n;
    for (int round = 0; round < (n % 4 == 0 ? 2 : 1) && result == FINE; round++) {
        starg_cover *cover = NULL;
        if (starg_cover_solve(context, &problem, &options, &cover) != STARG_OK)
            result = NO_COVER;
        else if (!is_cover(bits, cover))
            result = WRONG_COVER;
        else if (cover->lower_bound > OPTIMUM || cover->count < OPTIMUM)
            result = WRONG_BOUND;
        starg_cover_free(cover);
        if (round == 0 && asked < n)
            break; /* fewer than n allocations */
    }
    bool reached = asked >= n;
    starg_bits_free(bits);
    if (starg_context_live_blocks(context) != 0)
        result = LEAK;
    starg_context_free(context);
    if (_ZSt15get_new_handlerv() != NULL)
        result = HANDLER; /* the process's own handler is restored */
    return result != FINE ? result : reached ? FINE : NOT_REACHED;
}

static int solve_apart(size_t n) {
    int status = 0;
    fflush(stdout);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(solve(n)); /* the library's message goes to standard error */
    assert_int_equal(waitpid(child, &status, 0), child);
    if (!WIFEXITED(status))
        print_error("allocation %zu: killed by signal %d\n", n, WTERMSIG(status));
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void test_solver(void **state) {
    (void)state;
    bool more = getenv("STARGUARD_LONG") != NULL;
    size_t first = more ? 6000 : 6, part = more ? 48 : 1, attempts = 0, last = 0;
    for (size_t n = 1;; n += n < first ? 1 : 1 + 3 * n / (4 * part)) {
        int result = solve_apart(n);
        if (result == NOT_REACHED)
            break;
        if (result != FINE)
            print_error("allocation %zu: result %d\n", n, result);
        assert_int_equal(result, FINE);
        attempts++;
        last = n;
    }
    printf("%zu attempts, the last with allocation %zu failing\n", attempts, last);
    assert_true(last > 1000); /* both libraries were reached */
}

static void test_out_for_good(void **state) {
    (void)state;
    for_good = true;
    for (size_t n = 1; n <= 1000; n *= 10)
        assert_int_equal(solve_apart(n), OUT_OF_MEMORY);
    for_good = false;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_solver),
                                       cmocka_unit_test(test_out_for_good)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
