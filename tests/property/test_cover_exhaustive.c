/* SPDX-License-Identifier: Apache-2.0 */
/* Complete solves of small random problems against exhaustive search, in every mode. */
#include "core/rng.h"
#include "cover_oracle.h"
#include "support.h"

typedef struct random_problem {
    starg_cover_problem problem;
    starg_bits *bits;
    uint64_t weights[64];
    uint32_t given[3];
} random_problem;

static uint64_t random_weight(starg_rng *rng, int kind) {
    switch (kind) {
    case 0:
        return starg_rng_below(rng, 4); /* often 0 */
    case 1:
        return 1 + starg_rng_below(rng, 1000);
    default: /* huge ones next to small ones */
        return starg_rng_below(rng, 2) ? starg_rng_below(rng, (uint64_t)1 << 57)
                                       : starg_rng_below(rng, 5);
    }
}

/* Some rows and columns are repeated, for dominance and merging. */
static void fill_bits(starg_rng *rng, starg_bits *bits) {
    size_t rows = starg_bits_rows(bits), columns = starg_bits_columns(bits);
    uint64_t density = 5 + starg_rng_below(rng, 55);
    for (size_t i = 0; i < rows; i++) {
        bool repeats = i > 0 && starg_rng_below(rng, 8) == 0;
        size_t model = repeats ? starg_rng_below(rng, i) : 0;
        for (size_t j = 0; j < columns; j++) {
            bool one = starg_rng_below(rng, 100) < density;
            if (repeats)
                one = starg_bits_test(bits, model, j) && starg_rng_below(rng, 6) != 0;
            if (one)
                starg_bits_set(bits, i, j);
        }
    }
}

static void make_problem(starg_context *context, starg_rng *rng, size_t most_rows,
                         random_problem *out) {
    size_t rows = starg_rng_below(rng, most_rows + 1), columns = starg_rng_below(rng, 21);
    test_ok(context, starg_bits_create(context, rows, columns, &out->bits));
    fill_bits(rng, out->bits);
    starg_cover_problem_default(&out->problem);
    out->problem.rows = out->bits;
    out->problem.redundancy = 1 + (uint32_t)starg_rng_below(rng, 3);
    int kind = (int)starg_rng_below(rng, 4);
    for (size_t j = 0; j < columns; j++)
        out->weights[j] = random_weight(rng, kind);
    if (kind != 3)
        out->problem.weights = out->weights;
    uint64_t coverable = cover_oracle_coverable(&out->problem);
    switch (starg_rng_below(rng, 4)) {
    case 0:
        break;
    case 1:
        out->problem.target = coverable - coverable / 10;
        break;
    case 2:
        out->problem.target = coverable / 2;
        break;
    default:
        out->problem.target = coverable ? starg_rng_below(rng, coverable) : 0;
    }
    out->problem.given = out->given;
    if (rows > 0 && starg_rng_below(rng, 3) == 0)
        out->problem.given_count = 1 + starg_rng_below(rng, 3);
    for (size_t k = 0; k < out->problem.given_count; k++)
        out->given[k] = (uint32_t)starg_rng_below(rng, rows);
    if (starg_rng_below(rng, 2))
        out->problem.max_rows = 1 + starg_rng_below(rng, rows + 2);
}

static uint64_t smaller(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

static void check_order(const starg_cover_problem *problem, const starg_cover *cover) {
    for (size_t c = 0; c < cover->count; c++) {
        assert_true(cover->rows[c] < starg_bits_rows(problem->rows));
        for (size_t d = 0; d < c; d++)
            assert_int_not_equal(cover->rows[c], cover->rows[d]);
    }
    if (problem->redundancy != 1)
        return;
    uint64_t last = UINT64_MAX;
    for (size_t c = 0; c < cover->count; c++) {
        uint64_t adds = cover_oracle_weight(problem, cover->rows, c + 1) -
                        cover_oracle_weight(problem, cover->rows, c);
        assert_true(adds > 0 && adds <= last);
        if (adds == last)
            assert_true(cover->rows[c] > cover->rows[c - 1]);
        last = adds;
    }
}

/* Properties of every result, exact or not. */
static void check_result(const random_problem *random, const starg_cover *cover,
                         const uint64_t *best, bool exact) {
    const starg_cover_problem *problem = &random->problem;
    size_t rows = starg_bits_rows(problem->rows);
    uint64_t coverable = cover_oracle_coverable(problem);
    uint64_t goal = smaller(problem->target, coverable);
    size_t limit = problem->max_rows && problem->max_rows < rows ? problem->max_rows : rows;
    uint64_t heaviest = 0;
    for (size_t c = 0; c <= limit; c++)
        heaviest = heaviest > best[c] ? heaviest : best[c];

    check_order(problem, cover);
    assert_true(cover->count <= limit);
    assert_true(cover->weight == cover_oracle_weight(problem, cover->rows, cover->count));
    assert_true(cover->weight <= heaviest && heaviest <= cover->weight_bound);
    assert_true(cover->weight_bound <= coverable);
    assert_int_equal(cover->target_reached, cover->weight >= goal);
    if (problem->max_rows == 0) {
        assert_true(cover->target_reached);
        assert_true(cover->weight_bound == coverable);
    }
    size_t fewest = cover_oracle_fewest(best, rows, smaller(goal, cover->weight));
    assert_true(cover->lower_bound <= fewest && fewest <= cover->count);
    assert_int_equal(cover->optimal, cover->count == cover->lower_bound);
    assert_false(cover->time_limited);
    if (!exact)
        return;
    if (heaviest >= goal) {
        assert_true(cover->optimal);
        assert_true(cover->target_reached);
    } else {
        assert_true(cover->weight == heaviest && cover->weight_bound == heaviest);
    }
}

/* Guarantees of the prices: together they pay at most what any row can give, and the first bound up
 * to rounding; only a cover of less than everything has none. */
static void check_prices(const random_problem *random, const starg_cover *cover) {
    const starg_cover_problem *problem = &random->problem;
    if (cover->prices == NULL) {
        uint64_t coverable = cover_oracle_coverable(problem);
        assert_true(problem->target < coverable || cover->weight < coverable);
        return;
    }
    double bound = 0;
    for (size_t j = 0; j < starg_bits_columns(problem->rows); j++)
        assert_true(cover->prices[j] >= 0);
    if (problem->redundancy != 1)
        return;
    for (size_t j = 0; j < starg_bits_columns(problem->rows); j++)
        bound += cover->prices[j];
    for (size_t i = 0; i < starg_bits_rows(problem->rows); i++) {
        double paid = 0;
        for (size_t j = 0; j < starg_bits_columns(problem->rows); j++)
            paid += starg_bits_test(problem->rows, i, j) ? cover->prices[j] : 0;
        bound += paid > 1 ? 1 - paid : 0;
    }
    if (problem->max_rows == 0)
        assert_true(bound <= (double)cover->count + 1e-9);
}

static void solve_and_check(starg_context *context, const random_problem *random,
                            const uint64_t *best, starg_cover_method method) {
    starg_cover_options options;
    starg_cover_options_default(&options);
    options.method = method;
    options.prices = method == STARG_COVER_ILP;
    starg_cover *cover;
    test_ok(context, starg_cover_solve(context, &random->problem, &options, &cover));
    check_result(random, cover, best, method == STARG_COVER_ILP);
    if (options.prices)
        check_prices(random, cover);
    starg_cover_free(cover);
}

static void run_many(uint64_t stage, size_t count, size_t most_rows) {
    starg_context *context = test_context(1);
    for (uint64_t item = 0; item < count; item++) {
        starg_rng rng = starg_rng_make(1, stage, item);
        random_problem random = {0};
        uint64_t best[COVER_ORACLE_ROWS + 1];
        make_problem(context, &rng, most_rows, &random);
        cover_oracle_best(&random.problem, best);
        solve_and_check(context, &random, best, STARG_COVER_GREEDY);
        solve_and_check(context, &random, best, STARG_COVER_ILP);
        starg_bits_free(random.bits);
    }
    test_context_free(context);
}

static void small_problems(void **state) {
    (void)state;
    run_many(1, test_size(11000, 20000), 8);
}

static void larger_problems(void **state) {
    (void)state;
    run_many(2, 1500, 14);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_problems),
        cmocka_unit_test(larger_problems),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
