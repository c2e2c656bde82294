/* SPDX-License-Identifier: Apache-2.0 */
/* A problem of typical size: points on a sphere covered by caps, a few of them large and many
 * small. Solved to proven optimality; the seconds are printed, not asserted. */
#include <math.h>
#include <stdio.h>

#include "core/context.h"
#include "core/rng.h"
#include "cover_oracle.h"
#include "support.h"

enum { CAPS = 1000, POINTS = 20000, SPOTS = 30 };

static void random_direction(starg_rng *rng, double v[3]) {
    double z = 2 * starg_rng_unit(rng) - 1, angle = 8 * atan(1) * starg_rng_unit(rng);
    double r = sqrt(1 - z * z);
    v[0] = r * cos(angle);
    v[1] = r * sin(angle);
    v[2] = z;
}

static void add_cap(starg_bits *bits, size_t row, const double axis[3], double share) {
    for (size_t j = 0; j < POINTS; j++) {
        starg_rng rng = starg_rng_make(1, 31, j);
        double v[3];
        random_direction(&rng, v);
        if (axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2] >= 1 - 2 * share)
            starg_bits_set(bits, row, j);
    }
}

/* The caps cluster around a few spots, like views in the limbs of a body. */
static starg_bits *make_caps(starg_context *context) {
    starg_bits *bits;
    test_ok(context, starg_bits_create(context, CAPS, POINTS, &bits));
    for (size_t i = 0; i < CAPS; i++) {
        starg_rng rng = starg_rng_make(1, 32, i), spot = starg_rng_make(1, 33, i % SPOTS);
        double axis[3], off[3];
        random_direction(&spot, axis);
        random_direction(&rng, off);
        double length = 0;
        for (int k = 0; k < 3; k++) {
            axis[k] += 0.3 * off[k];
            length += axis[k] * axis[k];
        }
        for (int k = 0; k < 3; k++)
            axis[k] /= sqrt(length);
        add_cap(bits, i, axis, 0.02 + 0.06 * starg_rng_unit(&rng));
    }
    return bits;
}

static void solve_large(starg_context *context, const starg_bits *bits, double share) {
    starg_cover_problem problem;
    starg_cover *cover;
    starg_cover_problem_default(&problem);
    problem.rows = bits;
    if (share < 1)
        problem.target = (uint64_t)(share * POINTS);
    double start = starg_clock();
    test_ok(context, starg_cover_solve(context, &problem, NULL, &cover));
    printf("%d x %d, share %g: %zu rows, bound %zu, %zu nodes, %.3f s\n", CAPS, POINTS, share,
           cover->count, cover->lower_bound, cover->nodes, starg_clock() - start);
    assert_true(cover->target_reached);
    assert_true(cover->optimal || share < 1);
    assert_true(cover->lower_bound > 0 && cover->lower_bound <= cover->count);
    assert_true(cover->weight == cover_oracle_weight(&problem, cover->rows, cover->count));
    starg_cover_free(cover);
}

static void caps(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_bits *bits = make_caps(context);
    solve_large(context, bits, 1);
    solve_large(context, bits, 0.5);
    starg_bits_free(bits);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(caps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
