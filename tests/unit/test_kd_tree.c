/* SPDX-License-Identifier: Apache-2.0 */
/* The k-d tree against brute force. */
#include "geometry/kd_tree.h"

#include "core/rng.h"
#include "support.h"

enum { MOST = 400 };

static size_t nearest_of_all(const double *points, size_t count, int dimension, const double *p,
                             double *squared) {
    size_t best = 0;
    for (size_t i = 0; i < count; i++) {
        double sum = 0;
        for (int k = 0; k < dimension; k++) {
            double d = points[i * (size_t)dimension + (size_t)k] - p[k];
            sum += d * d;
        }
        if (i == 0 || sum < *squared) {
            best = i;
            *squared = sum;
        }
    }
    return best;
}

/* A coordinate: arbitrary, or on a small lattice, where many are equal. */
static double random_real(starg_rng *rng, bool lattice) {
    return lattice ? (double)starg_rng_below(rng, 4) : starg_rng_unit(rng);
}

static void finds_the_nearest(void **state) {
    (void)state;
    static double points[MOST * KD_TREE_MOST_DIMENSIONS];
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < 200; round++) {
        starg_rng rng = starg_rng_make(7, 0, round);
        int dimension = 1 + (int)(round % KD_TREE_MOST_DIMENSIONS);
        size_t count = 1 + starg_rng_below(&rng, round < 40 ? 8 : MOST);
        bool lattice = round % 3 == 0;
        kd_tree tree;
        for (size_t i = 0; i < count * (size_t)dimension; i++)
            points[i] = random_real(&rng, lattice);
        test_ok(context, kd_tree_create(context, points, count, dimension, &tree));
        for (size_t query = 0; query < 50; query++) {
            double p[KD_TREE_MOST_DIMENSIONS], squared = -1, expected = -1;
            for (int k = 0; k < dimension; k++)
                p[k] = 2 * random_real(&rng, lattice) - 0.5;
            size_t found = kd_tree_nearest(&tree, p, &squared);
            assert_int_equal(found, nearest_of_all(points, count, dimension, p, &expected));
            assert_true(squared == expected);
        }
        kd_tree_free(&tree);
    }
    test_context_free(context);
}

static void memory_may_give_out(void **state) {
    (void)state;
    size_t left = 0;
    const double point[3] = {1, 2, 3};
    kd_tree tree;
    left = 2; /* the context's own */
    starg_context *context = test_scarce_context(1, &left);
    left = 0;
    assert_int_equal(kd_tree_create(context, point, 1, 3, &tree), STARG_ERROR_MEMORY);
    kd_tree_free(&tree);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_nearest),
        cmocka_unit_test(memory_may_give_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
