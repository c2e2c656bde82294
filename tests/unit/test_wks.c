/* SPDX-License-Identifier: Apache-2.0 */
/* Wave kernel signatures on a string, whose modes are known in closed form, against the
 * definition. */
#include "shape/spectrum.h"

#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "models.h"

enum { N = 600, ENERGIES = STARG_DESCRIPTOR_ENERGIES, SPREAD = STARG_DESCRIPTOR_SPREAD };
static const double PI = 3.14159265358979323846;

typedef struct string {
    double masses[N], eigenvalues[WKS_MODES + 1], functions[(WKS_MODES + 1) * N];
} string;

/* Of length 1, free at both ends: cos(pi k x) with the eigenvalues (pi k)^2. */
static string *make_string(double scale) {
    string *s = malloc(sizeof *s);
    assert_non_null(s);
    for (size_t i = 0; i < N; i++)
        s->masses[i] = 1.0 / N;
    for (size_t k = 0; k <= WKS_MODES; k++) {
        s->eigenvalues[k] = scale * pow(PI * (double)k, 2);
        for (size_t i = 0; i < N; i++)
            s->functions[k * N + i] =
                (k > 0 ? sqrt(2) : 1) * cos(PI * (double)k * ((double)i + 0.5) / N);
    }
    return s;
}

static void measure(starg_context *context, string *s, size_t count,
                    double out[ENERGIES * SPREAD]) {
    const laplacian l = {.count = count, .masses = s->masses};
    test_ok(context, wks_measure(context, &l, s->eigenvalues, s->functions, out));
}

/* The density at a place by definition; the k-th eigenvalue is (pi k)^2. */
static double density(double x, size_t energy) {
    double growth = PI * PI * (WKS_MODES + 1) / 2, above = 0, below = 0;
    double e = 1.5 * pow(35 / 1.5, (double)energy / (ENERGIES - 1));
    for (int k = 1; k <= WKS_MODES; k++) {
        double weight = exp(-pow(log(PI * PI * k * k / growth / e) / 0.35, 2) / 2);
        above += weight * 2 * pow(cos(PI * k * x), 2);
        below += weight;
    }
    return above / below;
}

/* Quantile: at least that fraction of the string is below it, and not more below anything
 * greater. */
static void quantiles_of_a_string(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double scales[] = {1, 1e-30, 1e30};
    double out[ENERGIES * SPREAD];
    for (size_t round = 0; round < 3; round++) {
        string *s = make_string(scales[round]);
        measure(context, s, N, out);
        for (size_t e = 0; e < ENERGIES; e++)
            for (size_t q = 0; q < SPREAD; q++) {
                size_t below = 0, up_to = 0;
                double share = ((double)q + 0.5) / SPREAD;
                for (size_t i = 0; i < N; i++) {
                    double at = density(((double)i + 0.5) / N, e);
                    below += at < out[e * SPREAD + q] - 1e-9;
                    up_to += at < out[e * SPREAD + q] + 1e-9;
                }
                assert_true((double)below <= share * N + 1e-6);
                assert_true((double)up_to >= share * N - 1e-6);
            }
        free(s);
    }
    test_context_free(context);
}

/* Any other basis of an eigenspace gives the same. */
static void basis_does_not_count(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double before[ENERGIES * SPREAD], after[ENERGIES * SPREAD];
    string *s = make_string(1);
    s->eigenvalues[8] = s->eigenvalues[9];
    measure(context, s, N, before);
    for (size_t i = 0; i < N; i++) {
        double *x = &s->functions[8 * N + i], *y = &s->functions[9 * N + i], a = *x, b = *y;
        *x = cos(1.2) * a - sin(1.2) * b;
        *y = sin(1.2) * a + cos(1.2) * b;
    }
    measure(context, s, N, after);
    for (size_t i = 0; i < ENERGIES * SPREAD; i++)
        assert_true(fabs(before[i] - after[i]) < 1e-12);
    free(s);
    test_context_free(context);
}

/* One solution per component is 0 and does not vibrate; with more components than modes nothing
 * vibrates. */
static void components(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double out[ENERGIES * SPREAD];
    string *s = make_string(1);
    for (size_t k = 0; k <= WKS_MODES; k++)
        s->eigenvalues[k] = 0;
    measure(context, s, N, out);
    for (size_t i = 0; i < ENERGIES * SPREAD; i++)
        assert_true(out[i] == 1);
    free(s);
    s = make_string(1);
    s->eigenvalues[1] = 1e-12; /* a second zero, up to rounding */
    measure(context, s, N, out);
    for (size_t i = 0; i < N; i++)
        s->functions[N + i] = 1e6;
    double again[ENERGIES * SPREAD];
    measure(context, s, N, again);
    assert_memory_equal(out, again, sizeof out);
    free(s);
    test_context_free(context);
}

/* Quantiles are by mass: a point with twice the mass counts twice. */
static void masses_count(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    double one[ENERGIES * SPREAD], two[ENERGIES * SPREAD];
    string *s = make_string(1);
    for (size_t k = 0; k <= WKS_MODES; k++)
        for (size_t i = 0; i < N; i += 2)
            s->functions[k * N + i + 1] = s->functions[k * N + i];
    measure(context, s, N, one);
    for (size_t i = 0; i < N; i += 2)
        s->masses[i] = 2.0 / N, s->masses[i + 1] = 0;
    starg_rng rng = starg_rng_make(3, 0, 0);
    for (size_t k = 0; k <= WKS_MODES; k++) /* points without mass do not count */
        for (size_t i = 1; i < N; i += 2)
            s->functions[k * N + i] = starg_rng_unit(&rng);
    measure(context, s, N, two);
    for (size_t i = 0; i < ENERGIES * SPREAD; i++)
        assert_true(fabs(one[i] - two[i]) < 1e-9);
    free(s);
    test_context_free(context);
}

static void memory_may_give_out(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    string *s = make_string(1);
    left = 0;
    double out[ENERGIES * SPREAD];
    const laplacian l = {.count = N, .masses = s->masses};
    assert_int_equal(wks_measure(context, &l, s->eigenvalues, s->functions, out),
                     STARG_ERROR_MEMORY);
    left = SIZE_MAX;
    free(s);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(quantiles_of_a_string),
                                       cmocka_unit_test(basis_does_not_count),
                                       cmocka_unit_test(components), cmocka_unit_test(masses_count),
                                       cmocka_unit_test(memory_may_give_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
