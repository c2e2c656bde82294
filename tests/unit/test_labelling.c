/* SPDX-License-Identifier: Apache-2.0 */
/* Labellings against exhaustive search. */
#include "support.h"

#include <stdlib.h>
#include <string.h>

#include "star/certified/search.h"

enum { NODES_MOST = 8 };

/* Every node with three edges, none to itself; `labels` labels, or fewer for some nodes. */
static labelling random_problem(starg_context *context, starg_rng *rng, uint32_t nodes, int count) {
    labelling l = {.context = context};
    uint32_t ends[3 * NODES_MOST];
    starg_status status = STARG_OK;
    bool fine = false;
    for (uint32_t i = 0; i < 3 * nodes; i++)
        ends[i] = i / 3;
    while (!fine) {
        fine = true;
        for (uint32_t i = 3 * nodes - 1; i > 0; i--) {
            uint32_t other = (uint32_t)starg_rng_below(rng, i + 1), kept = ends[i];
            ends[i] = ends[other];
            ends[other] = kept;
        }
        for (uint32_t i = 0; i < 3 * nodes; i += 2)
            fine = fine && ends[i] != ends[i + 1];
    }
    for (uint32_t i = 0; i < 3 * nodes; i += 2) {
        labelling_edge edge = {.nodes = {ends[i], ends[i + 1]}};
        for (int k = 0; k < count; k++) {
            uint64_t where = starg_rng_below(rng, 3);
            if (where < 2)
                edge.fits[where] |= (label_set)1 << k;
        }
        STARG_PUSH(context, "test", &l.edges, edge);
    }
    for (uint32_t i = 0; i < nodes; i++) {
        label_set set = 0;
        for (int k = 0; k < count; k++)
            if (starg_rng_below(rng, 3) > 0)
                set |= (label_set)1 << k;
        STARG_PUSH(context, "test", &l.given, set);
    }
    for (int k = 0; k < count; k++)
        l.ranks[k] = starg_rng_unit(rng);
done:
    test_ok(context, status);
    test_ok(context, labelling_prepare(&l));
    return l;
}

static bool is_solution(const labelling *l, const label_set *chosen) {
    for (size_t i = 0; i < l->given.count; i++)
        if (chosen[i] == 0 || (chosen[i] & (chosen[i] - 1)) != 0 ||
            (chosen[i] & l->given.data[i]) == 0)
            return false;
    for (size_t i = 0; i < l->edges.count; i++) {
        const labelling_edge *edge = &l->edges.data[i];
        label_set a = chosen[edge->nodes[0]], b = chosen[edge->nodes[1]];
        if (a != b && ((a & edge->fits[0]) == 0 || (b & edge->fits[1]) == 0))
            return false;
    }
    return true;
}

static bool can_be_solved(const labelling *l, int count) {
    label_set chosen[NODES_MOST];
    size_t nodes = l->given.count, all = 1;
    for (size_t i = 0; i < nodes; i++)
        all *= (size_t)count;
    for (size_t number = 0; number < all; number++) {
        size_t rest = number;
        for (size_t i = 0; i < nodes; i++) {
            chosen[i] = (label_set)1 << rest % (size_t)count;
            rest /= (size_t)count;
        }
        if (is_solution(l, chosen))
            return true;
    }
    return false;
}

static void run_random(int count, size_t *solvable, size_t *solved) {
    starg_context *context = test_context(1);
    *solvable = *solved = 0;
    for (uint64_t seed = 0; seed < 1500; seed++) {
        starg_rng rng = starg_rng_make(seed, 90, (uint64_t)count);
        uint32_t nodes = 2 + 2 * (uint32_t)starg_rng_below(&rng, 3);
        labelling l = random_problem(context, &rng, nodes, count);
        bool possible = can_be_solved(&l, count), found;
        for (int again = 0; again < 2; again++) {
            label_set given[NODES_MOST];
            memcpy(given, l.given.data, nodes * sizeof *given);
            test_ok(context, labelling_solve(&l, &rng, &found));
            assert_memory_equal(given, l.given.data, nodes * sizeof *given);
            if (found)
                assert_true(is_solution(&l, l.left.data));
            assert_true(possible || !found);
        }
        *solvable += possible;
        *solved += found;
        labelling_free(&l);
    }
    test_context_free(context);
}

static void test_two_labels_are_never_missed(void **state) {
    (void)state;
    size_t solvable, solved;
    run_random(2, &solvable, &solved);
    assert_true(solvable > 300 && solvable < 1400);
    assert_int_equal(solvable, solved);
}

static void test_more_labels_are_seldom_missed(void **state) {
    (void)state;
    for (int count = 3; count <= 4; count++) {
        size_t solvable, solved;
        run_random(count, &solvable, &solved);
        print_message("%d labels: %zu of %zu solved\n", count, solved, solvable);
        assert_true(solvable > 300);
        assert_true(solved <= solvable && 20 * solved >= 19 * solvable);
    }
}

/* A ring whose edges forbid changes: all follow the label of the one fixed node. */
static void test_follows(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_status status = STARG_OK;
    starg_rng rng = starg_rng_make(1, 91, 0);
    labelling l = {.context = context};
    bool found;
    for (uint32_t i = 0; i < 6; i++) {
        const labelling_edge next = {.nodes = {i, (i + 1) % 6}}, across = {.nodes = {i, i + 3}};
        STARG_PUSH(context, "test", &l.edges, next);
        if (i < 3)
            STARG_PUSH(context, "test", &l.edges, across);
        STARG_PUSH(context, "test", &l.given, i == 4 ? 4u : 7u);
    }
    test_ok(context, labelling_prepare(&l));
    test_ok(context, labelling_solve(&l, &rng, &found));
    assert_true(found);
    for (uint32_t i = 0; i < 6; i++)
        assert_int_equal(l.left.data[i], 4);
    l.given.data[1] = 3;
    test_ok(context, labelling_solve(&l, &rng, &found));
    assert_false(found);
    l.given.data[1] = 0;
    test_ok(context, labelling_solve(&l, &rng, &found));
    assert_false(found);
done:
    test_ok(context, status);
    labelling_free(&l);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_labels_are_never_missed),
        cmocka_unit_test(test_more_labels_are_seldom_missed),
        cmocka_unit_test(test_follows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
