/* SPDX-License-Identifier: Apache-2.0 */
/* Exact integers and proofs about half-spaces against GMP: sums, differences and products limb by
 * limb; whatever is proven about half-spaces is true, and whatever can be proven is. */
#include <gmp.h>
#include <math.h>
#include <string.h>

#include "adversarial.h"
#include "exact_oracle.h"
#include "geometry/exact.h"
#include "geometry/linear_program.h"
#include "support.h"

enum { POINTS = 12, VALUES = 3 * POINTS, MOST_BITS = 800 };

typedef double (*points)[3];

static void refute(const char *what, point_family family, points x) {
    for (int i = 0; i < POINTS; i++)
        print_error("  {%a, %a, %a}\n", x[i][0], x[i][1], x[i][2]);
    fail_msg("%s, %s", what, point_family_name(family));
}

static void for_all(size_t rounds, void check(point_family family, starg_rng *rng, points x)) {
    for (int family = 0; family < POINT_FAMILIES; family++)
        for (uint64_t round = 0; round < rounds; round++) {
            starg_rng rng = starg_rng_make(19, (uint64_t)family, round);
            double x[POINTS][3];
            adversarial_points(&rng, (point_family)family, x, POINTS);
            check((point_family)family, &rng, x);
        }
}

/* ---- integers ---- */

static bool equals(const exact *number, const mpz_t expected) {
    mpz_t value;
    bool lean = number->count == 0 || number->limb[number->count - 1] != 0;
    mpz_init(value);
    mpz_import(value, (size_t)number->count, -1, sizeof number->limb[0], 0, 0, number->limb);
    if (number->sign < 0)
        mpz_neg(value, value);
    bool same = mpz_cmp(value, expected) == 0 && number->sign == mpz_sgn(expected);
    mpz_clear(value);
    return same && lean;
}

/* value / 2^scale; false if not an integer. */
static bool scaled(mpz_t out, double value, int scale) {
    mpq_t q;
    mpq_init(q);
    mpq_set_d(q, value);
    if (scale < 0)
        mpq_mul_2exp(q, q, (mp_bitcnt_t)-scale);
    else
        mpq_div_2exp(q, q, (mp_bitcnt_t)scale);
    bool whole = mpz_cmp_ui(mpq_denref(q), 1) == 0;
    mpz_set(out, mpq_numref(q));
    mpq_clear(q);
    return whole;
}

/* All values are integers in their scale, one of them is odd, and the largest has the reported
 * number of bits. */
static void check_scale(point_family family, points x, mpz_t *z, int scale, int bits) {
    size_t longest = 0;
    bool odd = false, any = false;
    for (int i = 0; i < VALUES; i++) {
        double value = x[i / 3][i % 3];
        if (!scaled(z[i], value, scale))
            refute("exact_scale leaves fractions", family, x);
        any = any || value != 0;
        odd = odd || mpz_odd_p(z[i]);
        size_t size = value != 0 ? mpz_sizeinbase(z[i], 2) : 0;
        longest = size > longest ? size : longest;
        if (bits <= 62 && (double)exact_small(value, scale) != mpz_get_d(z[i]))
            refute("exact_small", family, x);
    }
    if (any && (!odd || longest != (size_t)bits))
        refute("exact_scale", family, x);
}

/* (a + b) (c - d) (e + f) g and the like, of any values. */
static void check_sums(point_family family, starg_rng *rng, points x, mpz_t *z, int scale) {
    exact sum = {0}, term, factor, before;
    mpz_t expected, part;
    mpz_inits(expected, part, (mpz_ptr)NULL);
    for (int i = 0; i < 4; i++) {
        int first = (int)starg_rng_below(rng, VALUES), second = (int)starg_rng_below(rng, VALUES);
        exact_set(&term, x[first / 3][first % 3], scale);
        exact_set(&factor, x[second / 3][second % 3], scale);
        if (!equals(&term, z[first]) || !equals(&factor, z[second]))
            refute("exact_set", family, x);
        before = term;
        if (i % 2 == 0) {
            exact_add(&term, &before, &factor);
            mpz_add(part, z[first], z[second]);
        } else {
            exact_subtract(&term, &before, &factor);
            mpz_sub(part, z[first], z[second]);
        }
        if (!equals(&term, part))
            refute(i % 2 == 0 ? "exact_add" : "exact_subtract", family, x);
        before = sum;
        if (i == 0)
            sum = term;
        else
            exact_multiply(&sum, &before, &term);
        if (i == 0)
            mpz_set(expected, part);
        else
            mpz_mul(expected, expected, part);
        if (!equals(&sum, expected))
            refute("exact_multiply", family, x);
    }
    before = sum;
    exact_subtract(&sum, &before, &before);
    if (sum.sign != 0 || sum.count != 0)
        refute("a number less itself", family, x);
    mpz_clears(expected, part, (mpz_ptr)NULL);
}

static void check_integers(point_family family, starg_rng *rng, points x) {
    mpz_t z[VALUES];
    double values[VALUES];
    int bits, scale;
    memcpy(values, x, sizeof values);
    scale = exact_scale(values, VALUES, &bits);
    for (int i = 0; i < VALUES; i++)
        mpz_init(z[i]);
    check_scale(family, x, z, scale, bits);
    check_sums(family, rng, x, z, scale);
    for (int i = 0; i < VALUES; i++)
        mpz_clear(z[i]);
}

static void test_integers(void **state) {
    (void)state;
    for_all(test_rounds(1400, 70000), check_integers);
}

/* ---- half-spaces ---- */

static size_t proven, proven_in_box, alone;

static void choose(const half_space *all, int subset, half_space *spaces, const double *corners[12],
                   int *count) {
    *count = 0;
    for (int i = 0; i < 4; i++)
        if (subset >> i & 1) {
            corners[3 * *count] = all[i].a;
            corners[3 * *count + 1] = all[i].b;
            corners[3 * *count + 2] = all[i].c;
            spaces[(*count)++] = all[i];
        }
}

static int bits_of(const half_space *spaces, int count) {
    double values[36];
    int used = 0, bits;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            values[used++] = spaces[i].a[k];
            values[used++] = spaces[i].b[k];
            values[used++] = spaces[i].c[k];
        }
    exact_scale(values, (size_t)used, &bits);
    return bits;
}

/* Any weights can prove disjointness in a box, if they happen to be good. */
static void check_box(point_family family, starg_rng *rng, points x, const half_space *spaces,
                      const double *const *corners, int count) {
    double lower[3], upper[3], weights[4];
    for (int k = 0; k < 3; k++) {
        lower[k] = fmin(x[0][k], x[1][k]);
        upper[k] = fmax(x[0][k], x[1][k]);
    }
    for (int i = 0; i < 4; i++)
        weights[i] =
            starg_rng_below(rng, 3) == 0 ? starg_rng_unit(rng) : (double)starg_rng_below(rng, 3);
    if (!half_spaces_apart_in_box(spaces, weights, count, lower, upper))
        return;
    proven_in_box++;
    if (oracle_half_spaces_meet(corners, count, lower, upper))
        refute("half_spaces_apart_in_box", family, x);
}

/* All subsets: what is proven holds, and minimal subsets without a common point are proven. */
static void check_half_spaces(point_family family, starg_rng *rng, points x) {
    const half_space all[4] = {
        {x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}, {x[9], x[10], x[11]}};
    bool meet[16] = {true};
    for (int subset = 1; subset < 16; subset++) {
        half_space spaces[4];
        const double *corners[12];
        int count;
        bool least = true;
        choose(all, subset, spaces, corners, &count);
        for (int i = 0; i < 4; i++)
            least = least && (!(subset >> i & 1) || meet[subset & ~(1 << i)]);
        meet[subset] = least && oracle_half_spaces_meet(corners, count, NULL, NULL);
        bool apart = half_spaces_apart(spaces, count);
        if (apart && meet[subset])
            refute("half_spaces_apart", family, x);
        if (least && !meet[subset] && !apart && bits_of(spaces, count) <= MOST_BITS)
            refute("half_spaces_apart does not see it", family, x);
        proven += apart;
        alone += least && !meet[subset] && count == 4;
        check_box(family, rng, x, spaces, corners, count);
    }
}

static void test_half_spaces(void **state) {
    (void)state;
    for_all(test_rounds(100, 5000), check_half_spaces); /* of 15 subsets each */
    assert_true(proven > 500 && proven_in_box > 500 && alone > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_integers),
                                       cmocka_unit_test(test_half_spaces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
