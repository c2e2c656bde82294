/* SPDX-License-Identifier: Apache-2.0 */
/* Some pieces cut anew: what results is checked by brute force and in rationals
 * (partition_oracle.h). */
#include "support.h"

#include <stdlib.h>

#include "partition_oracle.h"
#include "star/certified/search.h"

static ruin_recreate_options options_of(uint64_t round, improve_tallies *tallies) {
    return (ruin_recreate_options){
        .trials = 600, .work = UINT64_MAX, .round = round, .tallies = tallies};
}

/* Guards and surface hold, there are no more pieces, and most are as they were. */
static void test_renewals(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    partition first = grown_sample(context, "gallery", 4000), p = partition_oracle_copy(&first);
    improve_tallies tallies = {0};
    size_t better = 0, kept = 0, before = first.pieces.count, rounds = test_size(10, 20);
    for (uint64_t round = 1; round <= rounds; round++) {
        ruin_recreate_report report;
        const ruin_recreate_options options = options_of(round, &tallies);
        uint64_t stamps = p.stamps;
        test_ok(context, ruin_recreate(&p, &options, &report));
        assert_true(report.work > 0);
        assert_int_equal(report.better, p.pieces.count < before);
        assert_true(p.pieces.count <= before);
        partition_oracle_check_guards(&p);
        partition_oracle_check_surface(&first, &p);
        for (uint32_t i = 0; i < p.pieces.count; i++)
            kept += p.pieces.data[i].stamp <= stamps;
        better += report.better;
        before = p.pieces.count;
    }
    print_message("%zu renewals of %zu were better, %zu pieces stayed\n", better, rounds, kept);
    assert_true(better > 1 && kept > 20);
    partition_free(&first);
    partition_free(&p);
    test_context_free(context);
}

/* The same at any number of threads. */
static void test_threads(void **state) {
    (void)state;
    partition done[2];
    starg_context *contexts[2];
    for (int i = 0; i < 2; i++) {
        improve_tallies tallies = {0};
        contexts[i] = test_context(1 + 2 * i);
        done[i] = grown_sample(contexts[i], "torus", 1000);
        for (uint64_t round = 1; round <= 6; round++) {
            ruin_recreate_report report;
            const ruin_recreate_options options = options_of(round, &tallies);
            test_ok(contexts[i], ruin_recreate(&done[i], &options, &report));
        }
    }
    assert_true(partition_oracle_same(&done[0], &done[1]));
    for (int i = 0; i < 2; i++) {
        partition_free(&done[i]);
        test_context_free(contexts[i]);
    }
}

/* Few or parted pieces, down to a single one. */
static void test_small(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t seed = 0; seed < 12; seed++) {
        partition first =
            seed == 0 ? random_hull(context, 1, 12) : random_cells(context, seed, 8 + (size_t)seed);
        partition p = partition_oracle_copy(&first);
        improve_tallies tallies = {0};
        for (uint64_t round = 1; round <= 4; round++) {
            ruin_recreate_report report;
            const ruin_recreate_options options = options_of(round, &tallies);
            test_ok(context, ruin_recreate(&p, &options, &report));
            partition_oracle_check_guards(&p);
        }
        assert_true(p.pieces.count >= 1 && p.pieces.count <= first.pieces.count);
        partition_oracle_check_surface(&first, &p);
        partition_free(&first);
        partition_free(&p);
    }
    test_context_free(context);
}

/* Every allocation fails once; errors leave nothing behind. */
static void test_memory(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    starg_status status = STARG_ERROR_MEMORY;
    for (size_t ration = 0; status != STARG_OK; ration += 1 + ration / 8) {
        size_t before = starg_context_live_blocks(context);
        partition p = random_cells(context, 3, 8);
        improve_tallies tallies = {0};
        ruin_recreate_report report;
        ruin_recreate_options options = options_of(1, &tallies);
        options.trials = 32;
        left = ration;
        status = ruin_recreate(&p, &options, &report);
        left = SIZE_MAX;
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        partition_free(&p);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_renewals),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_small),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
