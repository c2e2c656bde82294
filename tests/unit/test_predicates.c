/* SPDX-License-Identifier: Apache-2.0 */
/* Every predicate against rational arithmetic, on input families that break careless ones. */
#include <math.h>
#include <string.h>

#include "adversarial.h"
#include "exact_oracle.h"
#include "geometry/predicates.h"
#include "support.h"
#include "verify/sight.h"

enum { ROUNDS = 1500, LONG_ROUNDS = 70000, POINTS = 5 };

typedef double (*points)[3];

/* Prints the input and fails. */
static void refute(const char *what, point_family family, points x, int expected, int found) {
    for (int i = 0; i < POINTS; i++)
        print_error("  {%a, %a, %a}\n", x[i][0], x[i][1], x[i][2]);
    fail_msg("%s, %s: expected %d, found %d", what, point_family_name(family), expected, found);
}

/* Calls `check` with many inputs of every family. */
static void for_share(size_t share, void check(point_family family, points x)) {
    size_t rounds = test_rounds(ROUNDS / share, LONG_ROUNDS / share);
    for (int family = 0; family < POINT_FAMILIES; family++)
        for (uint64_t round = 0; round < rounds; round++) {
            starg_rng rng = starg_rng_make(11, (uint64_t)family, round);
            double x[POINTS][3];
            adversarial_points(&rng, (point_family)family, x, POINTS);
            check((point_family)family, x);
        }
}

static void for_all(void check(point_family family, points x)) {
    for_share(1, check);
}

static void check_orient3d(point_family family, points x) {
    int expected = oracle_orient3d(x[0], x[1], x[2], x[3]);
    int found = orient3d(x[0], x[1], x[2], x[3]);
    if (found != expected)
        refute("orient3d", family, x, expected, found);
    if (orient3d(x[1], x[0], x[2], x[3]) != -found || orient3d(x[0], x[2], x[1], x[3]) != -found ||
        orient3d(x[0], x[1], x[3], x[2]) != -found || orient3d(x[1], x[2], x[0], x[3]) != found ||
        orient3d(x[3], x[2], x[1], x[0]) != found)
        refute("orient3d of a permutation", family, x, expected, found);
}

static void test_orient3d(void **state) {
    (void)state;
    for_all(check_orient3d);
}

static void check_orient2d(point_family family, points x) {
    for (int u = 0; u < 3; u++)
        for (int v = 0; v < 3; v++) {
            if (u == v)
                continue;
            int expected = oracle_orient2d(x[0], x[1], x[2], u, v);
            int found = orient2d(x[0], x[1], x[2], u, v);
            if (found != expected)
                refute("orient2d", family, x, expected, found);
            if (orient2d(x[1], x[2], x[0], u, v) != found ||
                orient2d(x[1], x[0], x[2], u, v) != -found ||
                orient2d(x[0], x[1], x[2], v, u) != -found)
                refute("orient2d of a permutation", family, x, expected, found);
        }
}

static void test_orient2d(void **state) {
    (void)state;
    for_all(check_orient2d);
}

static void check_insphere(point_family family, points x) {
    int expected = oracle_insphere(x[0], x[1], x[2], x[3], x[4]);
    int found = insphere(x[0], x[1], x[2], x[3], x[4]);
    if (found != expected)
        refute("insphere", family, x, expected, found);
    if (insphere(x[1], x[0], x[2], x[3], x[4]) != -found ||
        insphere(x[0], x[1], x[3], x[2], x[4]) != -found ||
        insphere(x[1], x[2], x[3], x[0], x[4]) != -found ||
        insphere(x[1], x[0], x[3], x[2], x[4]) != found)
        refute("insphere of a permutation", family, x, expected, found);
}

static void test_insphere(void **state) {
    (void)state;
    for_all(check_insphere);
}

static void check_distance(point_family family, points x) {
    double exact = hypot(hypot(x[0][0] - x[1][0], x[0][1] - x[1][1]), x[0][2] - x[1][2]);
    const double radii[] = {exact,         nextafter(exact, INFINITY), nextafter(exact, 0),
                            fabs(x[2][0]), fabs(x[0][0] - x[1][0]),    0};
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
        if (radii[i] >= 1e100)
            continue;
        int expected = oracle_compare_distance(x[0], x[1], radii[i]);
        int found = compare_distance(x[0], x[1], radii[i]);
        if (found != expected)
            refute("compare_distance", family, x, expected, found);
        if (compare_distance(x[1], x[0], radii[i]) != found)
            refute("compare_distance turned round", family, x, expected, found);
    }
}

static void test_compare_distance(void **state) {
    (void)state;
    for_all(check_distance);
}

static void check_cone(point_family family, points x) {
    double *p = x[0], *q = x[1], *d = x[2];
    if (d[0] == 0 && d[1] == 0 && d[2] == 0)
        return;
    double far = 0, axis = 0, dot = 0;
    for (int k = 0; k < 3; k++) {
        far = hypot(far, q[k] - p[k]);
        axis = hypot(axis, d[k]);
        dot += (q[k] - p[k]) / 2 * d[k];
    }
    double edge = far > 0 && axis > 0 ? 2 * (dot / far / axis) : 0; /* the angle of q itself */
    edge = edge >= -1 && edge <= 1 ? edge : 1;
    const double cosines[] = {edge, nextafter(edge, -1), nextafter(edge, 1), 0, 1, -1, 0.5, -0.5};
    for (size_t i = 0; i < sizeof cosines / sizeof *cosines; i++) {
        int expected = oracle_compare_cone(p, d, cosines[i], q);
        int found = compare_cone(p, d, cosines[i], q);
        if (found != expected)
            refute("compare_cone", family, x, expected, found);
        if (verify_in_cone(p, d, cosines[i], q) != (expected >= 0))
            refute("verify_in_cone", family, x, expected, !(expected >= 0));
    }
}

static void test_compare_cone(void **state) {
    (void)state;
    for_all(check_cone);
}

static void check_plane(point_family family, points x) {
    const verify_view view = {.range = INFINITY,
                              .depth = INFINITY,
                              .framed = true,
                              .planes = {{x[2][0], x[2][1], x[2][2]},
                                         {x[2][0], x[2][1], x[2][2]},
                                         {x[2][0], x[2][1], x[2][2]},
                                         {x[2][0], x[2][1], x[2][2]}}};
    int expected = oracle_compare_plane(x[0], x[2], x[1]);
    int found = compare_plane(x[0], x[2], x[1]);
    if (found != expected)
        refute("compare_plane", family, x, expected, found);
    if (verify_in_view(&view, x[0], x[1]) != (expected >= 0))
        refute("verify_in_view", family, x, expected, !(expected >= 0));
}

static void test_compare_plane(void **state) {
    (void)state;
    for_all(check_plane);
}

/* The cosine of the angle that two vectors make, about, and others. */
static void list_cosines(const double u[3], const double v[3], double cosines[4]) {
    double first = hypot(hypot(u[0], u[1]), u[2]), second = hypot(hypot(v[0], v[1]), v[2]), dot = 0;
    for (int k = 0; k < 3 && first > 0 && second > 0; k++)
        dot += u[k] / first * (v[k] / second);
    double edge = dot >= -1 && dot <= 1 ? dot : 1;
    const double all[4] = {edge, nextafter(edge, -1), nextafter(edge, 1), 0.5};
    memcpy(cosines, all, sizeof all);
}

static void check_incidence(point_family family, points x) {
    const double *const t[3] = {x[0], x[1], x[2]};
    double u[3], v[3], n[3], line[3], cosines[4];
    for (int k = 0; k < 3; k++) {
        u[k] = x[2][k] - x[0][k];
        v[k] = x[1][k] - x[0][k];
        line[k] = x[3][k] - x[1][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    list_cosines(n, line, cosines);
    for (size_t i = 0; i < 4; i++) {
        bool all = true;
        if (!(cosines[i] >= 0))
            continue;
        for (int corner = 0; corner < 3; corner++) {
            int expected = oracle_compare_incidence(x[0], x[1], x[2], x[3], x[corner], cosines[i]);
            int found = compare_incidence(x[0], x[1], x[2], x[3], x[corner], cosines[i]);
            all = all && expected >= 0;
            if (found != expected)
                refute("compare_incidence", family, x, expected, found);
        }
        const verify_view view = {.steepest = cosines[i]};
        bool inner = oracle_orient3d(x[0], x[1], x[2], x[3]) > 0;
        if (inner && cosines[i] > 0 && verify_faces(&view, x[3], t, t) != all)
            refute("verify_faces", family, x, all, !all);
    }
}

static void test_compare_incidence(void **state) {
    (void)state;
    for_share(12, check_incidence);
}

static void check_parallax(point_family family, points x) {
    const double *const t[3] = {x[0], x[1], x[2]};
    double u[3], v[3], cosines[4];
    for (int k = 0; k < 3; k++) {
        u[k] = x[3][k] - x[0][k] + (x[3][k] - x[1][k]) + (x[3][k] - x[2][k]);
        v[k] = x[4][k] - x[0][k] + (x[4][k] - x[1][k]) + (x[4][k] - x[2][k]);
    }
    list_cosines(u, v, cosines);
    for (size_t i = 0; i < 4; i++) {
        int expected = oracle_compare_parallax(x[0], x[1], x[2], x[3], x[4], cosines[i]);
        int found = compare_parallax(x[0], x[1], x[2], x[3], x[4], cosines[i]);
        if (found != expected)
            refute("compare_parallax", family, x, expected, found);
        if (verify_apart(t, x[3], x[4], cosines[i]) != (expected <= 0))
            refute("verify_apart", family, x, expected <= 0, !(expected <= 0));
    }
}

static void test_compare_parallax(void **state) {
    (void)state;
    for_share(12, check_parallax);
}

static void check_collinear(point_family family, points x) {
    int expected = oracle_collinear(x[0], x[1], x[2]);
    int found = collinear(x[0], x[1], x[2]);
    if (found != expected || collinear(x[2], x[0], x[1]) != expected ||
        collinear(x[1], x[0], x[2]) != expected)
        refute("collinear", family, x, expected, found);
}

static void test_collinear(void **state) {
    (void)state;
    for_all(check_collinear);
}

/* The meaning of the signs, on obvious input. */
static void test_meaning(void **state) {
    (void)state;
    const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
    const double below[3] = {0.2, 0.2, -1}, above[3] = {0.2, 0.2, 1}, on[3] = {7, -3, 0};
    assert_int_equal(orient3d(a, b, c, below), 1);
    assert_int_equal(orient3d(a, b, c, above), -1);
    assert_int_equal(orient3d(a, b, c, on), 0);
    assert_int_equal(orient2d(a, b, c, 0, 1), 1);
    assert_int_equal(orient2d(a, b, c, 1, 0), -1);
    const double inside[3] = {0.2, 0.2, -0.1}, outside[3] = {5, 5, 5}, cospherical[3] = {1, 1, 0};
    assert_int_equal(insphere(a, b, c, below, inside), 1);
    assert_int_equal(insphere(a, b, c, below, outside), -1);
    assert_int_equal(insphere(a, b, c, below, cospherical), 0);
    assert_int_equal(insphere(b, a, c, below, inside), -1);
    assert_int_equal(compare_distance(a, cospherical, 1.4), 1);
    assert_int_equal(compare_distance(a, cospherical, 1.5), -1);
    assert_int_equal(compare_distance(a, b, 1), 0);
}

/* The families must reach zeros and both signs, otherwise the comparisons above prove little. */
static void test_families_reach_every_sign(void **state) {
    (void)state;
    for (int family = 0; family < POINT_FAMILIES; family++) {
        int seen[3] = {0};
        for (uint64_t round = 0; round < ROUNDS; round++) {
            starg_rng rng = starg_rng_make(11, (uint64_t)family, round);
            double x[POINTS][3];
            adversarial_points(&rng, (point_family)family, x, POINTS);
            seen[orient3d(x[0], x[1], x[2], x[3]) + 1]++;
        }
        assert_true(seen[0] > 10 && seen[1] > 10 && seen[2] > 10);
    }
}

/* ---- moving tetrahedra ---- */

/* From four points to the same four displaced by a part of the way to four others: corners may pass
 * through the opposite face and come back. */
static void check_moving(point_family family, const double (*x)[3], size_t *counts) {
    const double *from[4], *to[4];
    double end[4][3];
    static const double PARTS[4] = {1, 0.25, 0x1p-20, -0.5};
    for (int part = 0; part < 4; part++) {
        for (int i = 0; i < 4; i++) {
            for (int k = 0; k < 3; k++)
                end[i][k] = x[i][k] + PARTS[part] * (x[i + 4][k] - x[i][k]);
            from[i] = x[i];
            to[i] = end[i];
        }
        bool expected = oracle_stays_positive(from, to), found = stays_positive(from, to);
        if (found && !expected)
            fail_msg("stays_positive, %s, part %d: proven, but false", point_family_name(family),
                     part);
        counts[expected ? 1 : 0]++;
        counts[2] += expected && !found;
    }
}

static void test_stays_positive(void **state) {
    (void)state;
    size_t counts[3] = {0, 0, 0}, rounds = test_rounds(3 * ROUNDS / 20, LONG_ROUNDS / 10);
    for (int family = 0; family < POINT_FAMILIES; family++)
        for (uint64_t round = 0; round < rounds; round++) {
            starg_rng rng = starg_rng_make(12, (uint64_t)family, round);
            double x[8][3];
            adversarial_points(&rng, (point_family)family, x, 8);
            check_moving((point_family)family, (const double(*)[3])x, counts);
        }
    assert_true(counts[0] > rounds && counts[1] > rounds);
    assert_true(100 * counts[2] < counts[1]); /* so close to zero that it may be refused */
}

/* A determinant that touches zero at t = 1/2 only, and one that stays a little above. */
static void test_touching_zero(void **state) {
    (void)state;
    static const double from[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const double flat[4][3] = {{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
    double above[4][3];
    const double *a[4], *b[4], *c[4];
    memcpy(above, flat, sizeof above);
    above[1][1] = 0x1p-12; /* turns a little */
    above[2][0] = -0x1p-12;
    for (int i = 0; i < 4; i++) {
        a[i] = from[i];
        b[i] = flat[i];
        c[i] = above[i];
    }
    assert_false(stays_positive(a, b));
    assert_false(oracle_stays_positive(a, b));
    assert_true(stays_positive(a, a));
    assert_true(oracle_stays_positive(a, c));
    assert_true(stays_positive(a, c));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_orient3d),
        cmocka_unit_test(test_orient2d),
        cmocka_unit_test(test_insphere),
        cmocka_unit_test(test_compare_distance),
        cmocka_unit_test(test_compare_cone),
        cmocka_unit_test(test_compare_plane),
        cmocka_unit_test(test_compare_incidence),
        cmocka_unit_test(test_compare_parallax),
        cmocka_unit_test(test_collinear),
        cmocka_unit_test(test_stays_positive),
        cmocka_unit_test(test_touching_zero),
        cmocka_unit_test(test_meaning),
        cmocka_unit_test(test_families_reach_every_sign),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
