/* SPDX-License-Identifier: Apache-2.0 */
/* Intersections against linear elimination in rationals. */
#include "adversarial.h"
#include "exact_oracle.h"
#include "geometry/intersect.h"
#include "geometry/predicates.h"
#include "support.h"

enum { ROUNDS = 1000, LONG_ROUNDS = 70000, POINTS = 6 };

typedef double (*points)[3];

static void refute(const char *what, point_family family, points x, int expected, int found) {
    for (int i = 0; i < POINTS; i++)
        print_error("  {%a, %a, %a}\n", x[i][0], x[i][1], x[i][2]);
    fail_msg("%s, %s: expected %d, found %d", what, point_family_name(family), expected, found);
}

/* Calls `check` with many inputs of every family; it returns whether the shapes met. Every family
 * must give both answers. */
static void for_all(bool check(point_family family, uint64_t round, points x)) {
    size_t rounds = test_rounds(ROUNDS, LONG_ROUNDS);
    for (int family = 0; family < POINT_FAMILIES; family++) {
        size_t met = 0;
        for (uint64_t round = 0; round < rounds; round++) {
            starg_rng rng = starg_rng_make(12, (uint64_t)family, round);
            double x[POINTS][3];
            adversarial_points(&rng, (point_family)family, x, POINTS);
            met += check((point_family)family, round, x);
        }
        if (met == 0 || met == rounds)
            fail_msg("%s: all answers are %d", point_family_name((point_family)family), met != 0);
    }
}

static bool check_segment(point_family family, uint64_t round, points x) {
    (void)round;
    bool expected = oracle_segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]);
    bool found = segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]);
    if (found != expected)
        refute("segment_meets_triangle", family, x, expected, found);
    if (segment_meets_triangle(x[0], x[1], x[3], x[2], x[4]) != expected ||
        segment_meets_triangle(x[0], x[1], x[4], x[2], x[3]) != expected)
        refute("segment_meets_triangle, corners permuted", family, x, expected, !expected);
    return found;
}

static void test_segment(void **state) {
    (void)state;
    for_all(check_segment);
}

/* The end q at a corner, on an edge or inside the triangle: touching in q alone does not count. */
static bool check_segment_end(point_family family, uint64_t round, points x) {
    static const double weights[4][3] = {{1, 0, 0}, {0.5, 0.5, 0}, {0.25, 0.25, 0.5}, {0, 1, 0}};
    const double *w = weights[round % 4];
    for (int k = 0; k < 3; k++)
        x[1][k] = w[0] * x[2][k] + w[1] * x[3][k] + w[2] * x[4][k];
    check_segment(family, round, x);
    double swapped[POINTS][3];
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++)
            swapped[i][k] = x[i == 0 ? 1 : i == 1 ? 0 : i][k];
    return check_segment(family, round, swapped);
}

static void test_segment_end(void **state) {
    (void)state;
    for_all(check_segment_end);
}

static bool check_point(point_family family, uint64_t round, points x) {
    static const double weights[3][3] = {{0.25, 0.25, 0.5}, {0.5, 0, 0.5}, {0.75, 0.5, -0.25}};
    for (int k = 0; k < 3 && round % 2 == 0; k++) {
        const double *w = weights[round / 2 % 3];
        x[0][k] = w[0] * x[1][k] + w[1] * x[2][k] + w[2] * x[3][k];
    }
    bool expected = oracle_point_on_triangle(x[0], x[1], x[2], x[3]);
    bool found = point_on_triangle(x[0], x[1], x[2], x[3]);
    if (found != expected)
        refute("point_on_triangle", family, x, expected, found);
    return found;
}

static void test_point(void **state) {
    (void)state;
    for_all(check_point);
}

static bool check_segments(point_family family, uint64_t round, points x) {
    for (int k = 0; k < 3 && round % 2 == 0; k++) /* make them cross, as far as doubles allow */
        x[3][k] = x[0][k] + 0.5 * (x[1][k] - x[0][k]) - (x[2][k] - x[0][k]);
    bool expected = oracle_segments_meet(x[0], x[1], x[2], x[3]);
    bool found = segments_meet(x[0], x[1], x[2], x[3]);
    if (found != expected)
        refute("segments_meet", family, x, expected, found);
    if (segments_meet(x[3], x[2], x[0], x[1]) != found)
        refute("segments_meet turned round", family, x, expected, !found);
    return found;
}

static void test_segments(void **state) {
    (void)state;
    for_all(check_segments);
}

static bool check_triangles(point_family family, uint64_t round, points x) {
    int shared = (int)(round % 3);
    const double *s[3] = {x[0], x[1], x[2]};
    const double *t[3] = {shared > 0 ? x[0] : x[3], shared > 1 ? x[1] : x[4], x[5]};
    /* A shared corner of a zero-area triangle may coincide with its other corners; whether that is
     * a contact is up to the mesh check, which reports such faces anyway. */
    if (shared > 0 && (collinear(s[0], s[1], s[2]) || collinear(t[0], t[1], t[2])))
        return false;
    bool expected = oracle_triangles_contact(s, t, shared);
    triangle_contact found = triangles_contact(s, t, shared);
    bool contact = found == TRIANGLES_TOUCH || found == TRIANGLES_CROSS;
    if (contact != expected || (!contact && (found == TRIANGLES_SHARE) != (shared > 0)))
        refute("triangles_contact", family, x, expected, (int)found);
    if (triangles_contact(t, s, shared) != found)
        refute("triangles_contact turned round", family, x, (int)found, -1);
    return contact;
}

static void test_triangles(void **state) {
    (void)state;
    for_all(check_triangles);
}

/* The meaning of the kinds of contact, on obvious input. */
static void test_contact_kinds(void **state) {
    (void)state;
    const double a[3] = {0, 0, 0}, b[3] = {4, 0, 0}, c[3] = {0, 4, 0};
    const double below[3] = {1, 1, -1}, above[3] = {1, 1, 1}, side[3] = {9, 9, 1};
    const double on[3] = {1, 1, 0}, far_away[3] = {9, 9, 9}, up[3] = {9, 8, 3};
    const double *s[3] = {a, b, c};
    const double *crossing[3] = {below, above, side}, *touching[3] = {on, side, far_away};
    const double *apart[3] = {far_away, side, up}, *hinge[3] = {a, b, above};
    const double *folded[3] = {a, b, on}, *corner[3] = {a, below, far_away};
    assert_int_equal(triangles_contact(s, crossing, 0), TRIANGLES_CROSS);
    assert_int_equal(triangles_contact(s, touching, 0), TRIANGLES_TOUCH);
    assert_int_equal(triangles_contact(s, apart, 0), TRIANGLES_APART);
    assert_int_equal(triangles_contact(s, hinge, 2), TRIANGLES_SHARE);
    assert_int_equal(triangles_contact(s, folded, 2), TRIANGLES_CROSS);
    assert_int_equal(triangles_contact(s, corner, 1), TRIANGLES_CROSS);
    assert_int_equal(triangles_contact(s, s, 3), TRIANGLES_CROSS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_segment),   cmocka_unit_test(test_segment_end),
        cmocka_unit_test(test_point),     cmocka_unit_test(test_segments),
        cmocka_unit_test(test_triangles), cmocka_unit_test(test_contact_kinds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
