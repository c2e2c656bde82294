/* SPDX-License-Identifier: Apache-2.0 */
/* Retrieval measures: small cases by hand, and random tables with many ties against the
 * definitions. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "starguard/shape.h"
#include "support.h"

static void expect(double found, double wanted) {
    if (!(fabs(found - wanted) < 1e-12))
        fail_msg("%.17g, %.17g expected", found, wanted);
}

/* Four models: a query's own class has the first two. From 0 the other is second, from 1 first. */
static void by_hand(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double distances[16] = {0, 2, 1, 3,  //
                                  2, 0, 4, 3,  //
                                  1, 4, 0, 9,  //
                                  3, 3, 9, 0}; //
    const uint32_t class_of[4] = {0, 0, 1, 2};
    starg_retrieval classes[3], all;
    test_ok(context, starg_retrieval_measure(context, distances, class_of, 4, 3, classes, &all));
    assert_int_equal(classes[0].queries, 2);
    assert_int_equal(classes[0].models, 2);
    assert_int_equal(classes[1].queries, 0);
    assert_int_equal(all.queries, 2);
    assert_int_equal(all.models, 4);
    expect(classes[0].nearest_neighbour, 0.5);
    expect(classes[0].first_tier, 0.5);
    expect(classes[0].second_tier, 1);
    expect(classes[0].e_measure, 2 / (1 / (1.0 / 3) + 1 / 1.0)); /* three shown, one found */
    expect(classes[0].dcg, 1);                                   /* log2(2) is 1 */
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++)
        expect(classes[0].precision[i], 0.75);
    expect(classes[1].nearest_neighbour, 0);
    expect(all.second_tier, 1);
    test_context_free(context);
}

/* Perfect distances: 1 in every measure whose definition allows it. */
static void perfect(void **state) {
    (void)state;
    enum { N = 40 };
    starg_context *context = test_context(3);
    double distances[N * N];
    uint32_t class_of[N];
    starg_retrieval classes[4], all;
    for (size_t i = 0; i < N * N; i++)
        distances[i] = i / N == i % N ? 0 : i / N % 4 == i % N % 4 ? 1 : 2;
    for (uint32_t i = 0; i < N; i++)
        class_of[i] = i % 4;
    test_ok(context, starg_retrieval_measure(context, distances, class_of, N, 4, classes, &all));
    expect(all.nearest_neighbour, 1);
    expect(all.first_tier, 1);
    expect(all.second_tier, 1);
    expect(all.dcg, 1);
    expect(all.e_measure, 2 / (32 / 9.0 + 1));
    for (size_t i = 0; i < STARG_RECALL_LEVELS; i++)
        expect(all.precision[i], 1);
    test_context_free(context);
}

/* ---- by the definitions ---- */

typedef struct world {
    size_t count;
    double distances[60 * 60];
    uint32_t class_of[60];
} world;

/* Rank of a model for a query, from 1 on: one more than the models before it. */
static size_t place_of(const world *w, size_t query, size_t model) {
    size_t place = 1;
    double d = w->distances[query * w->count + model];
    for (size_t i = 0; i < w->count; i++) {
        double other = w->distances[query * w->count + i];
        if (i != query && i != model && w->class_of[i] != STARG_NO_CLASS)
            place += other < d || (other == d && i < model);
    }
    return place;
}

static size_t found_within(const world *w, size_t query, size_t places) {
    size_t found = 0;
    for (size_t i = 0; i < w->count; i++)
        found +=
            i != query && w->class_of[i] == w->class_of[query] && place_of(w, query, i) <= places;
    return found;
}

static starg_retrieval slow_query(const world *w, size_t query, size_t ranked) {
    starg_retrieval r = {.queries = 1};
    size_t relevant = found_within(w, query, ranked);
    double possible = 0, size = (double)relevant;
    r.nearest_neighbour = (double)found_within(w, query, 1);
    r.first_tier = (double)found_within(w, query, relevant) / size;
    r.second_tier = (double)found_within(w, query, 2 * relevant) / size;
    size_t shown = ranked < 32 ? ranked : 32;
    double hits = (double)found_within(w, query, shown);
    if (hits > 0)
        r.e_measure = 2 / ((double)shown / hits + size / hits);
    for (size_t place = 1; place <= ranked; place++) {
        double discount = place < 2 ? 1 : log(2) / log((double)place);
        r.dcg +=
            discount * (double)(found_within(w, query, place) - found_within(w, query, place - 1));
        possible += place <= relevant ? discount : 0;
    }
    r.dcg /= possible;
    for (size_t level = 0; level < STARG_RECALL_LEVELS; level++)
        for (size_t place = 1; place <= ranked; place++) {
            double found = (double)found_within(w, query, place);
            if (found * STARG_RECALL_LEVELS >= size * (double)(level + 1))
                r.precision[level] = fmax(r.precision[level], found / (double)place);
        }
    return r;
}

static void random_tables(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (uint64_t round = 0; round < 40; round++) {
        starg_rng rng = starg_rng_make(11, round, 0);
        world *w = calloc(1, sizeof *w);
        assert_non_null(w);
        w->count = 2 + starg_rng_below(&rng, 50);
        size_t class_count = 1 + starg_rng_below(&rng, 6), ranked = 0;
        uint64_t steps = round % 2 ? 3 : 1000;
        for (size_t i = 0; i < w->count; i++) {
            w->class_of[i] = (uint32_t)starg_rng_below(&rng, class_count);
            if (starg_rng_below(&rng, 8) == 0)
                w->class_of[i] = STARG_NO_CLASS;
            ranked += w->class_of[i] != STARG_NO_CLASS;
            for (size_t k = 0; k < i; k++)
                w->distances[i * w->count + k] = w->distances[k * w->count + i] =
                    (double)starg_rng_below(&rng, steps);
        }
        starg_retrieval classes[6], all, sum = {0};
        test_ok(context, starg_retrieval_measure(context, w->distances, w->class_of, w->count,
                                                 class_count, classes, &all));
        for (size_t i = 0; i < w->count; i++) {
            if (w->class_of[i] == STARG_NO_CLASS || found_within(w, i, w->count) == 0)
                continue;
            starg_retrieval q = slow_query(w, i, ranked - 1);
            sum.queries++;
            sum.nearest_neighbour += q.nearest_neighbour;
            sum.first_tier += q.first_tier;
            sum.second_tier += q.second_tier;
            sum.e_measure += q.e_measure;
            sum.dcg += q.dcg;
            for (size_t k = 0; k < STARG_RECALL_LEVELS; k++)
                sum.precision[k] += q.precision[k];
        }
        double n = sum.queries > 0 ? (double)sum.queries : 1;
        assert_int_equal(all.queries, sum.queries);
        assert_int_equal(all.models, ranked);
        expect(all.nearest_neighbour, sum.nearest_neighbour / n);
        expect(all.first_tier, sum.first_tier / n);
        expect(all.second_tier, sum.second_tier / n);
        expect(all.e_measure, sum.e_measure / n);
        expect(all.dcg, sum.dcg / n);
        for (size_t k = 0; k < STARG_RECALL_LEVELS; k++)
            expect(all.precision[k], sum.precision[k] / n);
        /* the classes' means, weighted by their queries, are the overall mean */
        double tiers = 0;
        for (size_t c = 0; c < class_count; c++)
            tiers += classes[c].first_tier * (double)classes[c].queries;
        expect(tiers / n, all.first_tier);
        free(w);
    }
    test_context_free(context);
}

static void refused(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double distances[4] = {0, 1, 1, 0};
    uint32_t class_of[2] = {0, 1};
    starg_retrieval classes[2], all;
    assert_int_equal(starg_retrieval_measure(context, distances, class_of, 2, 1, classes, &all),
                     STARG_ERROR_ARGUMENT);
    const double bad[] = {NAN, -1};
    for (size_t i = 0; i < 2; i++) {
        distances[1] = bad[i];
        assert_int_equal(starg_retrieval_measure(context, distances, class_of, 2, 2, classes, &all),
                         STARG_ERROR_ARGUMENT);
    }
    test_ok(context, starg_retrieval_measure(context, NULL, NULL, 0, 0, classes, &all));
    assert_int_equal(all.queries, 0);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(by_hand), cmocka_unit_test(perfect),
                                       cmocka_unit_test(random_tables), cmocka_unit_test(refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
