/* SPDX-License-Identifier: Apache-2.0 */
/* Piece elimination: random and computed fans of triangles, against brute force and in rationals
 * (partition_oracle.h). */
#include "support.h"

#include <math.h>
#include <stdlib.h>

#include "partition_oracle.h"
#include "star/certified/search.h"

enum { AROUND_MOST = 400 };

static const double MARGIN = 4e-6, SEARCH_MARGIN = 5e-6;

/* Pieces that share a facet with one of `pieces`, by number. */
static size_t find_around(const partition *p, const uint32_t *pieces, size_t count, uint32_t *out) {
    size_t found = 0;
    for (uint32_t other = 0; other < p->pieces.count; other++) {
        bool own = false, touches = false;
        for (size_t k = 0; k < count; k++)
            own = own || pieces[k] == other;
        for (size_t i = 0; i < p->facets.count && !own; i++)
            for (size_t k = 0; k < count; k++)
                for (int side = 0; side < 2; side++)
                    touches = touches || (p->facets.data[i].side[side] == pieces[k] &&
                                          p->facets.data[i].side[1 - side] == other);
        if (!own && touches && found < AROUND_MOST)
            out[found++] = other;
    }
    return found;
}

static double volume_of_all(const partition *p) {
    double sum = 0;
    for (uint32_t i = 0; i < p->pieces.count; i++)
        sum += partition_oracle_volume(p, i);
    return sum;
}

/* ---- fans ---- */

/* Assigns all facets of a piece to random takers, as a fan from its guard. */
static fan_plan random_fan(const partition *p, uint32_t number, starg_rng *rng) {
    starg_status status = STARG_OK;
    uint32_t around[AROUND_MOST];
    size_t count = find_around(p, &number, 1, around);
    fan_plan plan = {.piece_count = 1, .pieces = {number}};
    while (plan.taker_count < count && plan.taker_count < FAN_TAKERS_MOST) {
        plan.takers[plan.taker_count] = around[plan.taker_count];
        plan.taker_count++;
    }
    partition_to_unit(p, p->pieces.data[number].guard, plan.apex);
    for (uint32_t k = p->start.data[number]; k < p->start.data[number + 1]; k++) {
        STARG_PUSH(p->context, "test", &plan.entries, p->index.data[k]);
        STARG_PUSH(p->context, "test", &plan.takes,
                   (uint8_t)starg_rng_below(rng, plan.taker_count));
    }
done:
    test_ok(p->context, status);
    return plan;
}

/* Marked entries are found when facets have other numbers; not when one of them is split. */
static void check_found_again(const partition *p, fan_plan *plan, starg_rng *rng) {
    partition other = partition_oracle_copy(p);
    size_t count = other.facets.count;
    bool found;
    test_ok(p->context, fan_plan_mark(p, plan));
    for (size_t i = count; i > 1; i--) {
        size_t k = starg_rng_below(rng, i);
        facet swapped = other.facets.data[k];
        other.facets.data[k] = other.facets.data[i - 1];
        other.facets.data[i - 1] = swapped;
    }
    test_ok(p->context, partition_build_index(&other));
    test_ok(p->context, fan_plan_find(&other, plan, &found));
    assert_true(found);
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i], c[3];
        facet_outward(&other.facets.data[entry / 2], (int)(entry % 2), c);
        assert_memory_equal(c, plan->corners.data + 3 * i, sizeof c);
        assert_int_equal(other.facets.data[entry / 2].side[entry % 2], plan->pieces[0]);
    }
    uint32_t at = plan->entries.data[0];
    other.facets.data[at / 2].corners[1] = (uint32_t)(other.points.count / 3);
    test_ok(p->context, fan_plan_find(&other, plan, &found));
    assert_false(found);
    /* as they were */
    test_ok(p->context, fan_plan_find(p, plan, &found));
    assert_true(found);
    partition_free(&other);
}

/* The volume that each taker gets, by tetrahedra. */
static void volumes_taken(const partition *p, const fan_plan *plan, double *out) {
    for (size_t i = 0; i < plan->taker_count; i++)
        out[i] = 0;
    for (size_t i = 0; i < plan->entries.count; i++) {
        uint32_t entry = plan->entries.data[i], c[3];
        double e[3][3];
        facet_outward(&p->facets.data[entry / 2], (int)(entry % 2), c);
        for (int n = 0; n < 3; n++)
            for (int k = 0; k < 3; k++)
                e[n][k] = partition_unit(p, c[n])[k] - plan->apex[k];
        out[plan->takes.data[i]] += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                                     e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                                     e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
                                    6;
    }
}

static void test_fans_stay_closed(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    partition first = grown_sample(context, "torus", 900);
    for (uint32_t number = 0; number < first.pieces.count; number++) {
        starg_rng rng = starg_rng_make(3, 92, number);
        partition p = partition_oracle_copy(&first);
        fan_plan plan = random_fan(&p, number, &rng);
        double taken[FAN_TAKERS_MOST];
        check_found_again(&p, &plan, &rng);
        if (plan.taker_count == 0) {
            partition_free(&p);
            continue;
        }
        volumes_taken(&p, &plan, taken);
        test_ok(context, partition_fan(&p, &plan));
        for (size_t i = 0; i < plan.taker_count; i++) {
            double before = partition_oracle_volume(&first, plan.takers[i]);
            test_ok(context, partition_build_index(&p));
            assert_true(fabs(partition_oracle_volume(&p, plan.takers[i]) - before - taken[i]) <
                        1e-12);
        }
        partition_renumber(&p, (uint32_t)p.pieces.count - 1, number);
        test_ok(context, partition_build_index(&p));
        partition_oracle_check(&p);
        partition_oracle_check_surface(&first, &p);
        fan_plan_free(&plan);
        partition_free(&p);
    }
    partition_free(&first);
    test_context_free(context);
}

/* ---- the search ---- */

static void check_plan(const partition *p, const reassign_task *task, const fan_plan *plan) {
    size_t facets = 0;
    assert_int_equal(plan->piece_count, task->piece_count);
    assert_int_equal(plan->kept, task->kept);
    assert_int_equal(plan->entries.count, plan->takes.count);
    for (size_t i = 0; i < p->facets.count; i++) {
        bool own[2] = {false, false};
        for (int side = 0; side < 2; side++)
            for (size_t k = 0; k < task->piece_count; k++)
                own[side] = own[side] || p->facets.data[i].side[side] == task->pieces[k];
        facets += own[0] != own[1];
    }
    assert_int_equal(plan->entries.count, facets);
    for (size_t i = 0; i < plan->takes.count; i++)
        assert_true(plan->takes.data[i] < plan->taker_count);
}

/* Eliminates what it can, piece by piece; returns the number of pieces saved. */
static size_t reassign_all(partition *p, size_t size, size_t kept, uint64_t seed) {
    region_scratch scratch = {.context = p->context};
    partition first = partition_oracle_copy(p);
    size_t given = p->pieces.count, carried_out = 0;
    double volume = volume_of_all(p);
    for (uint32_t number = 0; number < p->pieces.count && p->pieces.count > size; number++) {
        uint32_t pieces[2] = {number}, around[AROUND_MOST];
        starg_rng rng = starg_rng_make(seed, 93, number);
        size_t count = find_around(p, pieces, 1, around);
        if (count == 0)
            continue;
        if (size == 2) {
            pieces[1] = around[starg_rng_below(&rng, count)];
            count = find_around(p, pieces, 2, around);
        }
        const reassign_task task = {pieces, size, kept, around, count, SEARCH_MARGIN};
        fan_plan plan;
        bool found;
        apply_effect effect;
        test_ok(p->context, reassign_find(p, &task, &rng, &scratch, &plan, &found));
        if (!found)
            continue;
        check_plan(p, &task, &plan);
        partition before = partition_oracle_copy(p);
        test_ok(p->context, apply_fan(p, &plan, MARGIN, &scratch, &effect));
        fan_plan_free(&plan);
        if (!effect.done)
            assert_true(partition_oracle_same(p, &before));
        else
            assert_int_equal(p->pieces.count + size - kept, before.pieces.count);
        partition_free(&before);
        carried_out += effect.done;
    }
    partition_oracle_check_guards(p);
    partition_oracle_check_surface(&first, p);
    assert_true(fabs(volume_of_all(p) - volume) < 1e-12);
    print_message("%zu pieces, %zu of %zu made %zu: %zu times\n", given, size, size, kept,
                  carried_out);
    region_scratch_free(&scratch);
    partition_free(&first);
    assert_true(size == kept || given - p->pieces.count == carried_out * (size - kept));
    return carried_out;
}

/* Numbers of pieces, before and after. */
static const size_t SIZES[4][2] = {{1, 0}, {1, 1}, {2, 1}, {2, 0}};

static void test_samples(void **state) {
    (void)state;
    static const char *const names[3] = {"torus", "knot", "horse"};
    starg_context *context = test_context(1);
    size_t done = 0;
    for (int n = 0; n < 3; n++)
        for (int i = 0; i < 4; i++) {
            partition p = grown_sample(context, names[n], 2000);
            for (uint64_t pass = 0; pass < 3; pass++)
                done += reassign_all(&p, SIZES[i][0], SIZES[i][1], pass);
            partition_free(&p);
        }
    assert_true(done > 3);
    test_context_free(context);
}

/* Tetrahedra that share only faces: most have neighbours that can take them. */
static void test_random_cells(void **state) {
    (void)state;
    static const size_t least[4] = {100, 3, 3, 0}; /* moves must make large pieces larger */
    starg_context *context = test_context(1);
    for (int i = 0; i < 4; i++) {
        size_t done = 0;
        for (uint64_t seed = 0; seed < 4; seed++) {
            partition p = random_cells(context, seed, 30);
            done += reassign_all(&p, SIZES[i][0], SIZES[i][1], seed);
            partition_free(&p);
        }
        assert_true(done >= least[i]);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fans_stay_closed),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_random_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
