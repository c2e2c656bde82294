/* SPDX-License-Identifier: Apache-2.0 */
/* Each stage of the cover alone, on small random instances, against exhaustive search: this reaches
 * cases that earlier stages would already have solved. */
#include <math.h>

#include "core/rng.h"
#include "cover/cover.h"
#include "cover/solver.h"
#include "cover_oracle.h"
#include "support.h"

enum { NONE = 99 };

/* best[c] of an instance with its own demands; a demand above the supply cannot be met. */
static void instance_best(const cover_instance *instance, uint64_t *best) {
    assert_true(instance->rows <= COVER_ORACLE_ROWS);
    for (size_t c = 0; c <= instance->rows; c++)
        best[c] = 0;
    for (uint64_t choice = 0; choice < (uint64_t)1 << instance->rows; choice++) {
        uint64_t sum = 0;
        for (size_t j = 0; j < instance->columns; j++) {
            uint64_t holders = instance->column_words ? cover_column(instance, j)[0] : 0;
            if ((uint32_t)__builtin_popcountll(holders & choice) >= instance->demands[j])
                sum += instance->weights[j];
        }
        int count = __builtin_popcountll(choice);
        if (sum > best[count])
            best[count] = sum;
    }
}

/* The fewest rows of a full cover; NONE if there is none. */
static size_t optimum(const cover_instance *instance) {
    uint64_t best[COVER_ORACLE_ROWS + 1];
    instance_best(instance, best);
    size_t count = cover_oracle_fewest(best, instance->rows, instance->total);
    return count > instance->rows ? NONE : count;
}

static uint64_t heaviest(const cover_instance *instance, size_t rows) {
    uint64_t best[COVER_ORACLE_ROWS + 1], most = 0;
    instance_best(instance, best);
    for (size_t c = 0; c <= rows && c <= instance->rows; c++)
        most = most > best[c] ? most : best[c];
    return most;
}

/* `kind` 0: anything; 1: each column in two or three rows (few reductions, LP not tight). */
static void make_instance(starg_context *context, starg_rng *rng, int kind, cover_instance *out) {
    size_t rows = 1 + starg_rng_below(rng, 11), columns = 1 + starg_rng_below(rng, 20);
    uint64_t density = 10 + starg_rng_below(rng, 50);
    uint64_t weights[20];
    starg_bits *bits;
    test_ok(context, starg_bits_create(context, rows, columns, &bits));
    for (size_t j = 0; j < columns; j++) {
        weights[j] = 1 + starg_rng_below(rng, 9);
        for (size_t i = 0; i < rows && kind == 0; i++) {
            if (starg_rng_below(rng, 100) < density)
                starg_bits_set(bits, i, j);
        }
        for (int k = 0; k < 3 && kind == 1; k++)
            starg_bits_set(bits, starg_rng_below(rng, rows), j);
    }
    starg_cover_problem problem;
    uint64_t given;
    starg_cover_problem_default(&problem);
    problem.rows = bits;
    problem.weights = weights;
    problem.redundancy = 1 + (uint32_t)starg_rng_below(rng, 3);
    test_ok(context, cover_instance_build(context, &problem, out, &given));
    starg_bits_free(bits);
}

typedef void instance_check(cover_run *run, starg_rng *rng, cover_instance *instance);

static void for_instances(uint64_t stage, size_t count, instance_check *check) {
    starg_context *context = test_context(1);
    for (uint64_t item = 0; item < count; item++) {
        starg_rng rng = starg_rng_make(1, stage, item);
        cover_run run = {.context = context, .max_nodes = 100000};
        cover_instance instance;
        make_instance(context, &rng, (int)(item % 2), &instance);
        check(&run, &rng, &instance);
        cover_instance_free(&instance);
    }
    test_context_free(context);
}

static void keep_part(cover_instance *instance, const uint64_t *rows, const uint64_t *columns) {
    cover_instance part;
    assert_int_equal(cover_instance_select(instance, rows, columns, &part), STARG_OK);
    cover_instance_free(instance);
    *instance = part;
}

static void check_essential(cover_run *run, starg_rng *rng, cover_instance *instance) {
    (void)rng;
    size_t before = optimum(instance);
    uint64_t rows[1] = {0};
    cover_names forced = {0};
    if (cover_mark_essential(instance, rows) != 0)
        test_ok(run->context, cover_take_rows(instance, rows, NULL, &forced));
    assert_int_equal(forced.count + optimum(instance), before);
    STARG_ARRAY_FREE(run->context, &forced);
}

static void check_rows(cover_run *run, starg_rng *rng, cover_instance *instance) {
    (void)rng;
    uint64_t before[COVER_ORACLE_ROWS + 2];
    size_t rows_before = instance->rows, dropped;
    for (size_t k = 0; k <= rows_before; k++)
        before[k] = heaviest(instance, k);
    uint64_t rows[1];
    cover_mask_fill(rows, instance->rows);
    test_ok(run->context, cover_drop_dominated_rows(run, instance, rows, &dropped));
    assert_int_equal(dropped, instance->rows - starg_bit_count(rows, 1));
    keep_part(instance, rows, NULL);
    for (size_t k = 0; k <= rows_before; k++) /* in every mode: for each number of rows */
        assert_true(heaviest(instance, k) == before[k]);
}

static void check_columns(cover_run *run, starg_rng *rng, cover_instance *instance) {
    (void)rng;
    size_t before = optimum(instance), dropped;
    uint64_t columns[1];
    cover_mask_fill(columns, instance->columns);
    test_ok(run->context, cover_drop_dominated_columns(run, instance, columns, &dropped));
    assert_int_equal(dropped, instance->columns - starg_bit_count(columns, instance->row_words));
    keep_part(instance, NULL, columns);
    assert_int_equal(optimum(instance), before);
}

static void check_blocks(cover_run *run, starg_rng *rng, cover_instance *instance) {
    (void)rng;
    uint32_t block[COVER_ORACLE_ROWS];
    size_t count, sum = 0, before = optimum(instance);
    test_ok(run->context, cover_find_blocks(instance, block, &count));
    for (uint32_t number = 0; number < count; number++) {
        uint64_t rows[1] = {0}, columns[1] = {0};
        cover_instance part;
        for (size_t i = 0; i < instance->rows; i++) {
            if (block[i] != number)
                continue;
            starg_bit_set(rows, i);
            for (size_t w = 0; w < instance->row_words; w++)
                columns[w] |= cover_row(instance, i)[w];
        }
        for (size_t i = 0; i < instance->rows; i++) { /* they share nothing */
            if (block[i] != number && instance->row_words != 0)
                assert_true((cover_row(instance, i)[0] & columns[0]) == 0);
        }
        test_ok(run->context, cover_instance_select(instance, rows, columns, &part));
        sum += optimum(&part);
        cover_instance_free(&part);
    }
    assert_int_equal(sum, before);
}

static void check_reduce_full(cover_run *run, starg_rng *rng, cover_instance *instance) {
    (void)rng;
    size_t before = optimum(instance);
    cover_names forced = {0};
    bool feasible;
    test_ok(run->context, cover_reduce_full(run, instance, &forced, NULL, &feasible));
    assert_true(feasible);
    assert_int_equal(forced.count + optimum(instance), before);
    STARG_ARRAY_FREE(run->context, &forced);
}

static void random_multipliers(starg_rng *rng, const cover_instance *instance, int64_t *out) {
    uint64_t most = (uint64_t)1 << (1 + starg_rng_below(rng, 22));
    for (size_t j = 0; j < instance->columns; j++)
        out[j] = (int64_t)starg_rng_below(rng, most);
}

/* Reduced-cost fixing loses no optimal cover of at most `most` rows. */
static void check_fixing(cover_run *run, const cover_instance *instance, const cover_dual *dual,
                         size_t least, size_t most) {
    uint64_t keep[1], take[1] = {0};
    cover_names forced = {0};
    cover_instance rest;
    cover_mask_fill(keep, instance->rows);
    if (!cover_dual_fix(instance, dual, most, keep, take))
        return;
    test_ok(run->context, cover_instance_select(instance, NULL, NULL, &rest));
    test_ok(run->context, cover_take_rows(&rest, take, keep, &forced));
    size_t left = optimum(&rest);
    if (least <= most)
        assert_int_equal(forced.count + left, least);
    else
        assert_true(left == NONE || forced.count + left >= least);
    cover_instance_free(&rest);
    STARG_ARRAY_FREE(run->context, &forced);
}

static void check_dual(cover_run *run, starg_rng *rng, cover_instance *instance) {
    size_t least = optimum(instance);
    int64_t multipliers[20], scratch[COVER_ORACLE_ROWS];
    cover_dual dual;
    cover_state best;
    test_ok(run->context, cover_dual_create(instance, &dual));
    test_ok(run->context, cover_state_create(instance, &best));
    assert_true(cover_dual_rows(dual.value) <= least);
    random_multipliers(rng, instance, multipliers);
    assert_true(cover_dual_rows(cover_dual_value(instance, multipliers, scratch)) <= least);

    test_ok(run->context, cover_greedy(run, &best, instance->total, instance->rows));
    cover_drop_needless(&best, instance->total);
    assert_true(best.weight == instance->total && best.count >= least);
    test_ok(run->context, cover_lagrange(run, instance, &dual, &best));
    assert_true(cover_dual_rows(dual.value) <= least);
    assert_true(best.weight == instance->total && best.count >= least);
    for (size_t most = least > 2 ? least - 2 : 0; most <= least + 1; most++)
        check_fixing(run, instance, &dual, least, most);

    cover_state_free(&best);
    cover_dual_free(&dual);
}

/* A full cover from all rows in random order, without redundant ones. */
static void random_cover(starg_rng *rng, const cover_instance *instance, cover_state *out) {
    size_t order[COVER_ORACLE_ROWS] = {0};
    for (size_t i = 0; i < instance->rows; i++) {
        size_t other = starg_rng_below(rng, i + 1);
        order[i] = order[other];
        order[other] = i;
    }
    for (size_t i = 0; i < instance->rows && out->weight < instance->total; i++)
        cover_state_add(out, order[i]);
    cover_drop_needless(out, instance->total);
}

/* Recounts: the rows are distinct and meet every column's demand. */
static void assert_covers(const cover_instance *instance, const cover_state *cover) {
    uint64_t choice = 0;
    for (size_t c = 0; c < cover->count; c++) {
        assert_true(cover->rows[c] < instance->rows && !(choice >> cover->rows[c] & 1));
        choice |= (uint64_t)1 << cover->rows[c];
    }
    for (size_t j = 0; j < instance->columns; j++) {
        int held = __builtin_popcountll(cover_column(instance, j)[0] & choice);
        assert_true((uint32_t)held >= instance->demands[j]);
    }
    assert_true(cover->weight == instance->total);
}

/* The local search need not find an optimum; counts how often it misses one, or its goal. */
static size_t searches, misses;

static void check_local(cover_run *run, starg_rng *rng, cover_instance *instance) {
    size_t least = optimum(instance);
    cover_state best;
    test_ok(run->context, cover_state_create(instance, &best));
    random_cover(rng, instance, &best);
    size_t before = best.count, enough = starg_rng_below(rng, before + 1);
    test_ok(run->context, cover_local_search(run, enough, &best));
    assert_true(best.count >= least && best.count <= before);
    searches++;
    misses += best.count > (least > enough ? least : enough);
    if (instance->columns != 0)
        assert_covers(instance, &best);
    cover_state_free(&best);
}

static void check_relax(cover_run *run, starg_rng *rng, cover_instance *instance) {
    (void)rng;
    size_t least = optimum(instance);
    cover_relaxation relaxation;
    bool found;
    int64_t reduced[COVER_ORACLE_ROWS];
    double sum = 0;
    test_ok(run->context, cover_relax(run, instance, &relaxation, &found));
    assert_int_equal(found, instance->columns != 0);
    for (size_t j = 0; j < instance->columns; j++) {
        double held = 0;
        for (size_t i = 0; i < instance->rows; i++)
            held += cover_column(instance, j)[0] >> i & 1 ? relaxation.solution[i] : 0;
        assert_true(held > instance->demands[j] - 1e-5);
        assert_true(fabs(held - instance->demands[j] - relaxation.surplus[j]) < 1e-9);
    }
    for (size_t i = 0; i < instance->rows; i++) {
        assert_true(relaxation.solution[i] > -1e-6 && relaxation.solution[i] < 1 + 1e-6);
        sum += relaxation.solution[i];
    }
    int64_t value = cover_dual_value(instance, relaxation.multipliers, reduced);
    assert_true(cover_dual_rows(value) <= least);
    assert_true(fabs((double)value / (double)COVER_ONE - sum) < 1e-3); /* strong duality */
    cover_relaxation_free(&relaxation);
}

static void check_ilp(cover_run *run, starg_rng *rng, cover_instance *instance) {
    size_t least = optimum(instance), bound;
    cover_state best;
    test_ok(run->context, cover_state_create(instance, &best));
    random_cover(rng, instance, &best);
    test_ok(run->context, cover_ilp_solve(run, instance, &best, &bound));
    assert_int_equal(best.count, least);
    assert_int_equal(bound, least);
    if (instance->columns != 0)
        assert_covers(instance, &best);
    cover_state_free(&best);
}

/* Far more columns than the relaxation and branch and bound start with. */
static void make_wide_instance(starg_context *context, starg_rng *rng, cover_instance *out) {
    enum { ROWS = 14, COLUMNS = 700 };
    starg_bits *bits;
    test_ok(context, starg_bits_create(context, ROWS, COLUMNS, &bits));
    size_t size = 3 + starg_rng_below(rng, 3);
    for (size_t j = 0; j < COLUMNS; j++) {
        for (size_t k = 0; k < size; k++)
            starg_bits_set(bits, starg_rng_below(rng, ROWS), j);
    }
    starg_cover_problem problem;
    uint64_t given;
    starg_cover_problem_default(&problem);
    problem.rows = bits;
    problem.redundancy = 1 + (uint32_t)starg_rng_below(rng, 2);
    test_ok(context, cover_instance_build(context, &problem, out, &given));
    starg_bits_free(bits);
}

/* The dual's value and reduced costs equal their defining sums, column by column. */
static void check_dual_sums(starg_rng *rng, const cover_instance *instance) {
    enum { MOST_ROWS = 14, MOST_COLUMNS = 700 };
    int64_t multipliers[MOST_COLUMNS], reduced[MOST_ROWS], value = 0;
    for (size_t j = 0; j < instance->columns; j++) {
        multipliers[j] = (int64_t)(starg_rng_below(rng, 5) * starg_rng_below(rng, COVER_ONE / 100));
        value += multipliers[j] * instance->demands[j];
    }
    int64_t told = cover_dual_value(instance, multipliers, reduced);
    for (size_t i = 0; i < instance->rows; i++) {
        int64_t cost = COVER_ONE;
        for (size_t j = 0; j < instance->columns; j++)
            if (cover_column(instance, j)[0] >> i & 1)
                cost -= multipliers[j];
        assert_true(reduced[i] == cost);
        value += cost < 0 ? cost : 0;
    }
    assert_true(told == value);
}

static void lazy_columns(void **state) {
    (void)state;
    size_t widest = 0;
    starg_context *context = test_context(1);
    for (uint64_t item = 0; item < test_rounds(8, 20); item++) {
        starg_rng rng = starg_rng_make(1, 9, item);
        cover_run run = {.context = context, .max_nodes = 100000};
        cover_instance instance;
        make_wide_instance(context, &rng, &instance);
        assert_true(instance.columns > 200);
        widest = instance.columns > widest ? instance.columns : widest;
        check_dual_sums(&rng, &instance);
        check_relax(&run, &rng, &instance);
        check_ilp(&run, &rng, &instance);
        check_local(&run, &rng, &instance);
        cover_instance_free(&instance);
    }
    assert_true(widest > 512); /* several strips of cover_dual_value */
    test_context_free(context);
}

/* The linear relaxation in its plain form, in floating point: the most weight of `rows` rows, as a
 * fraction of the total. */
static double plain_relaxation(const cover_instance *instance, double rows) {
    enum { MOST_ROWS = COVER_ORACLE_ROWS };
    int n = (int)instance->rows, m = (int)instance->columns, all[MOST_ROWS];
    double ones[MOST_ROWS];
    CoinBigIndex starts[2] = {0, n};
    double unit = (double)instance->total / m; /* suits the solver's tolerance */
    Clp_Simplex *model = Clp_newModel();
    Clp_setLogLevel(model, 0);
    Clp_resize(model, 0, n + m); /* x, then y */
    for (int v = 0; v < n + m; v++) {
        Clp_columnUpper(model)[v] = 1;
        Clp_objective(model)[v] = v < n ? 0 : -(double)instance->weights[v - n] / unit;
    }
    for (int i = 0; i < n; i++) {
        all[i] = i;
        ones[i] = 1;
    }
    Clp_addRows(model, 1, NULL, &rows, starts, all, ones);
    for (int j = 0; j < m; j++) {
        int index[MOST_ROWS + 1] = {n + j}, count = 1;
        double value[MOST_ROWS + 1] = {-(double)instance->demands[j]}, zero = 0;
        for (int i = 0; i < n; i++) {
            if (cover_column(instance, (size_t)j)[0] >> i & 1) {
                index[count] = i;
                value[count++] = 1;
            }
        }
        starts[1] = count;
        Clp_addRows(model, 1, &zero, NULL, starts, index, value);
    }
    Clp_initialSolve(model);
    assert_int_equal(Clp_status(model), 0);
    double most = -Clp_objectiveValue(model) / m;
    Clp_deleteModel(model);
    return most;
}

/* Both bounds are at least as good as the plain relaxation's. */
static void check_against_plain(cover_run *run, const cover_instance *instance, size_t rows,
                                uint64_t goal, cover_weight_bound *bound) {
    double total = (double)instance->total;
    test_ok(run->context, cover_weight_bound_create(instance, rows, goal, bound));
    test_ok(run->context, cover_weight_bound_relax(run, instance, false, 0, bound));
    assert_true((double)bound->most / total <= plain_relaxation(instance, (double)rows) + 1e-6);
    test_ok(run->context, cover_weight_bound_relax(run, instance, true, instance->rows, bound));
    if (bound->least < instance->rows)
        assert_true(plain_relaxation(instance, (double)bound->least) >=
                    (double)goal / total - 1e-6);
}

static void check_weight_bound(cover_run *run, starg_rng *rng, cover_instance *instance) {
    uint64_t best[COVER_ORACLE_ROWS + 1];
    if (instance->rows == 0 || instance->columns == 0)
        return;
    instance_best(instance, best);
    size_t rows = starg_rng_below(rng, instance->rows + 1);
    uint64_t goal = 1 + starg_rng_below(rng, instance->total), most = heaviest(instance, rows);
    size_t least = cover_oracle_fewest(best, instance->rows, goal);
    cover_weight_bound bound;
    check_against_plain(run, instance, rows, goal, &bound);
    assert_true(bound.most >= most && bound.least <= least);

    bool exhausted;
    cover_state found;
    test_ok(run->context, cover_state_create(instance, &found));
    test_ok(run->context,
            cover_search(run, instance, &bound, 0, instance->total, &found, &exhausted));
    assert_true(exhausted && found.weight == most && found.count <= rows);
    cover_state_free(&found);
    cover_weight_bound_free(&bound);
}

/* Weights for the columns of a wide instance: equal, or of all magnitudes up to the limit of the
 * scaled sums. */
static void set_weights(starg_rng *rng, bool extreme, cover_instance *instance) {
    instance->total = 0;
    for (size_t j = 0; j < instance->columns; j++) {
        uint64_t weight = 1 + starg_rng_below(rng, 1000);
        if (extreme)
            weight = 1 + starg_rng_below(rng, (uint64_t)1 << starg_rng_below(rng, 53));
        instance->weights[j] = weight;
        instance->total += weight;
    }
}

/* More columns than a round adds; extreme weights, whose small ones the solver does not see: bounds
 * are valid, equal those of the plain relaxation, and grow with the goal. */
static void many_columns(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (uint64_t item = 0; item < test_rounds(8, 20); item++) {
        starg_rng rng = starg_rng_make(1, 13, item);
        cover_run run = {.context = context};
        cover_instance instance;
        uint64_t best[COVER_ORACLE_ROWS + 1];
        size_t before = 0;
        make_wide_instance(context, &rng, &instance);
        set_weights(&rng, item % 2 != 0, &instance);
        instance_best(&instance, best);
        for (uint64_t percent = 50; percent <= 100; percent += 10) {
            uint64_t goal = instance.total / 100 * percent;
            size_t rows = percent / 10;
            cover_weight_bound bound;
            check_against_plain(&run, &instance, rows, goal, &bound);
            assert_true(bound.most >= heaviest(&instance, rows));
            assert_true(bound.least <= cover_oracle_fewest(best, instance.rows, goal));
            assert_true(bound.least >= before);
            before = bound.least;
            cover_weight_bound_free(&bound);
        }
        cover_instance_free(&instance);
    }
    test_context_free(context);
}

/* Parts of the bound: each row's score is the sum over its columns. */
static void check_scores(const cover_instance *instance, const cover_weight_bound *bound) {
    for (size_t k = 0; k < instance->rows; k++) {
        uint64_t sum = 0;
        for (size_t j = 0; j < instance->columns; j++)
            if (cover_column(instance, j)[0] >> bound->scores[k].row & 1)
                sum += bound->trial[j];
        assert_true(bound->scores[k].score == sum);
    }
}

/* Rows of several words, most of them full or nearly so. */
static void wide_rows(void **state) {
    (void)state;
    enum { COLUMNS = 200 };
    starg_context *context = test_context(1);
    for (uint64_t item = 0; item < 100; item++) {
        starg_rng rng = starg_rng_make(1, 12, item);
        cover_run run = {.context = context, .max_nodes = 100000};
        size_t rows = 2 + starg_rng_below(&rng, 6), columns = 60 + starg_rng_below(&rng, 140);
        uint64_t density = 50 + starg_rng_below(&rng, 51), weights[COLUMNS], given;
        starg_bits *bits;
        cover_instance instance;
        cover_weight_bound bound;
        starg_cover_problem problem;
        test_ok(context, starg_bits_create(context, rows, columns, &bits));
        for (size_t j = 0; j < columns; j++) {
            weights[j] = 1 + starg_rng_below(&rng, 9);
            for (size_t i = 0; i < rows; i++)
                if (starg_rng_below(&rng, 100) < density)
                    starg_bits_set(bits, i, j);
        }
        starg_cover_problem_default(&problem);
        problem.rows = bits;
        problem.weights = weights;
        test_ok(context, cover_instance_build(context, &problem, &instance, &given));
        test_ok(context, cover_weight_bound_create(&instance, 1, instance.total, &bound));
        check_scores(&instance, &bound);
        test_ok(context, cover_weight_bound_relax(&run, &instance, false, 0, &bound));
        check_scores(&instance, &bound);
        assert_true(bound.most >= heaviest(&instance, 1));
        cover_weight_bound_free(&bound);
        cover_instance_free(&instance);
        starg_bits_free(bits);
    }
    test_context_free(context);
}

#define STAGE(NAME, NUMBER, COUNT)                                                                 \
    static void NAME(void **state) {                                                               \
        (void)state;                                                                               \
        for_instances(NUMBER, COUNT, check_##NAME);                                                \
    }
STAGE(essential, 1, 3000)
STAGE(rows, 2, 1500)
STAGE(columns, 3, 3000)
STAGE(blocks, 4, 3000)
STAGE(reduce_full, 5, 3000)
STAGE(dual, 6, 1000)
STAGE(ilp, 7, 300)
STAGE(weight_bound, 8, 1500)
STAGE(relax, 11, 500)

static void local(void **state) {
    (void)state;
    searches = misses = 0;
    for_instances(10, 1500, check_local);
    assert_true(searches == 1500 && 100 * misses <= searches);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(essential),    cmocka_unit_test(rows),
        cmocka_unit_test(columns),      cmocka_unit_test(blocks),
        cmocka_unit_test(dual),         cmocka_unit_test(ilp),
        cmocka_unit_test(reduce_full),  cmocka_unit_test(weight_bound),
        cmocka_unit_test(wide_rows),    cmocka_unit_test(local),
        cmocka_unit_test(relax),        cmocka_unit_test(lazy_columns),
        cmocka_unit_test(many_columns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
