/* SPDX-License-Identifier: Apache-2.0 */
/* Prices of witnesses and the bounds that they prove, against enumeration. */
#include "support.h"

#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "guard/bound.h"
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
        prices_free(context, &prices);
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
        uint64_t whole[MOST_WITNESSES], work = 0;
        size_t least = 1;
        while (!holds(&p, p.wanted, least))
            least++;
        test_ok(context, prices_find(context, p.list, p.count, &p.wanted, NULL, &prices));
        bound_round(prices.price, whole);
        size_t bound = bound_of_prices(p.list, p.count, whole, 1);
        assert_true(bound <= least && (double)bound > prices.sum - 1e-2);
        for (size_t most = 0; most <= least; most++) {
            bool proven;
            test_ok(context, bound_by_branching(context, p.list, p.count, &p.wanted, most, 100000,
                                                &proven, NULL, &work));
            assert_true(proven == (most < least));
            branched += proven && most >= bound;
        }
        prices_free(context, &prices);
    }
    assert_true(branched > 5);
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
        uint64_t whole[MOST_WITNESSES], work = 0;
        test_ok(context, prices_find(context, p.list, p.count, &p.wanted, NULL, &prices));
        bound_round(prices.price, whole);
        size_t bound = bound_of_prices(p.list, p.count, whole, 1);
        if (bound > 1) {
            bool proven = true;
            p.rows[starg_hash64(item) % p.count] = p.wanted;
            assert_int_equal(bound_of_prices(p.list, p.count, whole, 1), 1);
            test_ok(context, bound_by_branching(context, p.list, p.count, &p.wanted, bound - 1,
                                                1000, &proven, NULL, &work));
            assert_false(proven);
            tried++;
        }
        prices_free(context, &prices);
    }
    assert_true(tried > 20);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_prices_meet_their_cover),
        cmocka_unit_test(test_bounds_against_enumeration),
        cmocka_unit_test(test_corrupted_row_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
