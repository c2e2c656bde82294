/* SPDX-License-Identifier: Apache-2.0 */
/* Prices of witnesses and the bounds that they prove, against enumeration. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "guard/prices.h"

enum { MOST_ROWS = 25 };

typedef struct problem {
    witness_row rows[MOST_ROWS];
    const witness_row *list[MOST_ROWS];
    size_t count;
    witness_row wanted; /* the targets of some row */
} problem;

static problem random_problem(uint64_t item) {
    starg_rng rng = starg_rng_make(3, 14, item);
    problem p = {.count = 5 + starg_rng_below(&rng, MOST_ROWS - 5)};
    size_t witnesses = 3 + starg_rng_below(&rng, 40), stride = 1 + starg_rng_below(&rng, 25);
    double share = 0.12 + 0.4 * starg_rng_unit(&rng);
    for (size_t i = 0; i < p.count; i++)
        for (size_t j = 0; j < witnesses; j++)
            if (starg_rng_unit(&rng) < share) {
                starg_bit_set(p.rows[i].bits, stride * j);
                starg_bit_set(p.wanted.bits, stride * j);
            }
    return p;
}

static void link_rows(problem *p) {
    for (size_t i = 0; i < p->count; i++)
        p->list[i] = &p->rows[i];
}

/* Do `most` rows cover all remaining targets? Tries the rows of the first one. */
static bool holds(const problem *p, witness_row left, size_t most) {
    for (size_t j = 0; j < MOST_WITNESSES; j++) {
        if (!starg_bit_test(left.bits, j))
            continue;
        for (size_t i = 0; i < p->count && most > 0; i++) {
            witness_row rest = left;
            if (!starg_bit_test(p->rows[i].bits, j))
                continue;
            for (int w = 0; w < WITNESS_WORDS; w++)
                rest.bits[w] &= ~p->rows[i].bits[w];
            if (holds(p, rest, most - 1))
                return true;
        }
        return false;
    }
    return true;
}

static void test_prices_meet_their_cover(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t item = 0; item < 300; item++) {
        problem p = random_problem(item);
        link_rows(&p);
        witness_prices prices;
        test_ok(context, prices_find(context, p.list, p.count, &p.wanted, NULL, &prices));
        double cover = 0;
        for (size_t i = 0; i < p.count; i++) {
            assert_true(row_value(&p.rows[i], prices.price) <= 1 + 1e-12);
            cover += prices.share[i];
        }
        for (size_t j = 0; j < MOST_WITNESSES; j++) {
            double share = 0;
            for (size_t i = 0; i < p.count; i++)
                share += starg_bit_test(p.rows[i].bits, j) ? prices.share[i] : 0;
            assert_true(prices.price[j] >= 0);
            if (starg_bit_test(p.wanted.bits, j))
                assert_true(share > 1 - 1e-9);
            else
                assert_true(prices.price[j] == 0);
        }
        assert_true(fabs(cover - prices.sum) < 2e-3);
        prices_free(&prices);
    }
    test_context_free(context);
}

static void test_bounds_against_enumeration(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t branched = 0;
    for (uint64_t item = 0; item < 300; item++) {
        problem p = random_problem(item);
        link_rows(&p);
        witness_prices prices;
        whole_prices whole;
        uint64_t work = 0;
        size_t least = 1;
        while (!holds(&p, p.wanted, least))
            least++;
        test_ok(context, prices_find(context, p.list, p.count, &p.wanted, NULL, &prices));
        bound_round(&prices, NULL, &whole);
        size_t bound = bound_of_prices(p.list, p.count, &whole, 1);
        assert_true(bound <= least && (double)bound > prices.sum - 1e-2);
        for (size_t most = 0; most <= least; most++) {
            bool proven;
            const branch_question question = {p.list, p.count, &p.wanted, most, 100000};
            test_ok(context, bound_by_branching(context, &question, &proven, NULL, &work));
            assert_true(proven == (most < least));
            branched += proven && most >= bound;
        }
        prices_free(&prices);
    }
    assert_true(branched > 5);
    test_context_free(context);
}

static size_t held_of(const witness_row *row, const odd_set *set) {
    size_t held = 0;
    for (size_t i = 0; i < set->count; i++)
        held += starg_bit_test(row->bits, set->witness[i]);
    return held;
}

/* The fractional cover holds too little of each set from number `first` on. */
static void check_violated(const problem *p, const witness_prices *prices, const odd_sets *sets,
                           size_t first) {
    for (size_t k = first; k < sets->count; k++) {
        const odd_set *set = &sets->set[k];
        double halves = 0;
        assert_true(set->count % 2 == 1 && set->count >= 3 && set->count <= ODD_SET_SIZE);
        for (size_t i = 1; i < set->count; i++)
            assert_true(set->witness[i - 1] < set->witness[i]);
        for (size_t i = 0; i < p->count; i++)
            halves += (double)((held_of(p->list[i], set) + 1) / 2) * prices->share[i];
        assert_true(halves < (set->count + 1.0) / 2 - 0.01);
    }
}

static void check_worth(const problem *p, const witness_prices *prices, const odd_sets *sets) {
    for (size_t i = 0; i < p->count; i++) {
        double worth = row_value(p->list[i], prices->price);
        for (size_t k = 0; k < sets->count; k++)
            worth += (double)((held_of(p->list[i], &sets->set[k]) + 1) / 2) * prices->odd[k];
        assert_true(worth <= 1 + 1e-9);
        assert_true(fabs(worth - prices_of_row(prices, sets, p->list[i])) < 1e-12);
    }
}

/* Odd sets that are found are violated, and what they prove is true. */
static void test_odd_sets(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t raised = 0, sharp = 0;
    odd_sets *sets = calloc(1, sizeof *sets);
    assert_non_null(sets);
    for (uint64_t item = 0; item < 300; item++) {
        problem p = random_problem(item);
        link_rows(&p);
        size_t least = 1, added = 1, first = 0;
        uint64_t work = 0;
        sets->count = 0;
        while (!holds(&p, p.wanted, least))
            least++;
        for (int round = 0; round < 10 && added > 0; round++) {
            witness_prices prices;
            whole_prices whole;
            test_ok(context, prices_find(context, p.list, p.count, &p.wanted, sets, &prices));
            check_worth(&p, &prices, sets);
            bound_round(&prices, sets, &whole);
            size_t bound = bound_of_prices(p.list, p.count, &whole, 1);
            assert_true(bound <= least && (double)bound > prices.sum - 1e-2);
            if (round == 0)
                first = bound;
            raised += round > 0 && bound > first;
            sharp += round > 0 && bound > first && bound == least;
            first = bound > first ? bound : first;
            const odd_sets_question question = {p.list, prices.share, p.count, prices.price};
            test_ok(context, odd_sets_renew(context, &question, sets, prices.odd, &added, &work));
            check_violated(&p, &prices, sets, sets->count - added);
            prices_free(&prices);
        }
    }
    print_message("bounds raised %zu times, %zu times to the optimum\n", raised, sharp);
    assert_true(raised > 5 && sharp > 3);
    free(sets);
    test_context_free(context);
}

/* All witnesses and sets at the highest prices, for the most redundancy: the sum is exact. */
static void test_highest(void **state) {
    (void)state;
    witness_prices *prices = calloc(1, sizeof *prices);
    odd_sets *sets = calloc(1, sizeof *sets);
    whole_prices *whole = calloc(1, sizeof *whole);
    assert_true(prices != NULL && sets != NULL && whole != NULL);
    const double highest = nextafter(BOUND_HIGHEST, 0);
    for (size_t j = 0; j < MOST_WITNESSES; j++)
        prices->price[j] = highest;
    for (sets->count = 0; sets->count < MOST_ODD_SETS; sets->count++) {
        prices->odd[sets->count] = highest;
        sets->set[sets->count].count = ODD_SET_SIZE;
    }
    bound_round(prices, sets, whole);
    const uint64_t one = BOUND_HIGHEST * BOUND_ONE - 1, half = BOUND_MOST_TIMES * ODD_SET_SIZE / 2;
    const long double all = (long double)MOST_WITNESSES * BOUND_MOST_TIMES * one +
                            (long double)MOST_ODD_SETS * half * one;
    assert_true((long double)bound_worth_of_all(whole, BOUND_MOST_TIMES) == all);
    prices->price[0] = BOUND_HIGHEST;
    bound_round(prices, sets, whole);
    assert_true(whole->price[0] == 0 && whole->price[1] == one);
    free(prices);
    free(sets);
    free(whole);
}

/* Three witnesses of which any two are seen together need two. */
static void test_three(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    odd_sets *sets = calloc(1, sizeof *sets);
    problem p = {.count = 3};
    witness_prices prices;
    uint64_t work = 0;
    size_t added;
    assert_non_null(sets);
    link_rows(&p);
    for (size_t i = 0; i < 3; i++) {
        starg_bit_set(p.rows[i].bits, 10 * i);
        starg_bit_set(p.rows[i].bits, 10 * ((i + 1) % 3));
        starg_bit_set(p.wanted.bits, 10 * i);
    }
    test_ok(context, prices_find(context, p.list, 3, &p.wanted, sets, &prices));
    assert_true(fabs(prices.sum - 1.5) < 2e-3);
    const odd_sets_question question = {p.list, prices.share, 3, prices.price};
    test_ok(context, odd_sets_renew(context, &question, sets, prices.odd, &added, &work));
    assert_int_equal(added, 1);
    prices_free(&prices);
    test_ok(context, prices_find(context, p.list, 3, &p.wanted, sets, &prices));
    assert_true(fabs(prices.sum - 2) < 2e-3);
    prices_free(&prices);
    free(sets);
    test_context_free(context);
}

/* If a leaf may see more than before, what was proven without that is no longer proven. */
static void test_corrupted_row_is_noticed(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t tried = 0;
    for (uint64_t item = 0; item < 100; item++) {
        problem p = random_problem(item);
        link_rows(&p);
        witness_prices prices;
        whole_prices whole;
        uint64_t work = 0;
        test_ok(context, prices_find(context, p.list, p.count, &p.wanted, NULL, &prices));
        bound_round(&prices, NULL, &whole);
        size_t bound = bound_of_prices(p.list, p.count, &whole, 1);
        if (bound > 1) {
            bool proven = true;
            p.rows[starg_hash64(item) % p.count] = p.wanted;
            assert_int_equal(bound_of_prices(p.list, p.count, &whole, 1), 1);
            const branch_question question = {p.list, p.count, &p.wanted, bound - 1, 1000};
            test_ok(context, bound_by_branching(context, &question, &proven, NULL, &work));
            assert_false(proven);
            tried++;
        }
        prices_free(&prices);
    }
    assert_true(tried > 20);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_prices_meet_their_cover),
        cmocka_unit_test(test_bounds_against_enumeration),
        cmocka_unit_test(test_odd_sets),
        cmocka_unit_test(test_highest),
        cmocka_unit_test(test_three),
        cmocka_unit_test(test_corrupted_row_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
