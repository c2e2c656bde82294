/* SPDX-License-Identifier: Apache-2.0 */
/* Rational points against fractions of GMP: constructions, signs, rounding; triangulations of
 * random segments. */
#include "geometry/exact_points.h"

#include <gmp.h>
#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "mesh/topology.h"
#include "mesh/union/arrangement.h"
#include "support.h"

/* ---- fractions ---- */

static void from_exact(mpz_t out, const exact *x) {
    mpz_import(out, (size_t)x->count, -1, sizeof *x->limb, 0, 0, x->limb);
    if (x->sign < 0)
        mpz_neg(out, out);
}

/* Coordinate k of a point, in model units. */
static void coordinate(mpq_t out, const exact_point *point, int k, int scale) {
    from_exact(mpq_numref(out), &point->x[k]);
    from_exact(mpq_denref(out), &point->x[3]);
    mpq_canonicalize(out);
    if (scale >= 0)
        mpq_mul_2exp(out, out, (mp_bitcnt_t)scale);
    else
        mpq_div_2exp(out, out, (mp_bitcnt_t)-scale);
}

/* Sign of (b - a) x (c - a) . (p - a), by fractions. */
static int side_by_fractions(const double *a, const double *b, const double *c, mpq_t p[3]) {
    mpq_t m[3][3], sum, term;
    mpq_inits(sum, term, (mpq_ptr)NULL);
    for (int k = 0; k < 3; k++) {
        mpq_inits(m[0][k], m[1][k], m[2][k], (mpq_ptr)NULL);
        mpq_set_d(term, a[k]);
        mpq_set_d(m[0][k], b[k]);
        mpq_set_d(m[1][k], c[k]);
        mpq_sub(m[0][k], m[0][k], term);
        mpq_sub(m[1][k], m[1][k], term);
        mpq_sub(m[2][k], p[k], term);
    }
    for (int k = 0; k < 6; k++) {
        int i = k % 3, j = (i + 1 + k / 3) % 3, l = 3 - i - j;
        mpq_mul(term, m[0][i], m[1][j]);
        mpq_mul(term, term, m[2][l]);
        if (k < 3)
            mpq_add(sum, sum, term);
        else
            mpq_sub(sum, sum, term);
    }
    int sign = mpq_sgn(sum);
    for (int k = 0; k < 3; k++)
        mpq_clears(m[0][k], m[1][k], m[2][k], (mpq_ptr)NULL);
    mpq_clears(sum, term, (mpq_ptr)NULL);
    return sign;
}

/* No other double is nearer. */
static void expect_nearest(const mpq_t x, double rounded) {
    mpq_t error, other;
    mpq_inits(error, other, (mpq_ptr)NULL);
    mpq_set_d(error, rounded);
    mpq_sub(error, error, x);
    mpq_abs(error, error);
    for (int up = 0; up < 2; up++) {
        mpq_set_d(other, nextafter(rounded, up ? INFINITY : -INFINITY));
        mpq_sub(other, other, x);
        mpq_abs(other, other);
        assert_true(mpq_cmp(error, other) <= 0);
    }
    mpq_clears(error, other, (mpq_ptr)NULL);
}

/* The point lies in these planes, is rounded correctly, and on the right side of another plane. */
static void expect_point(const exact_point *point, double (*corner)[3], int planes, int scale) {
    mpq_t p[3];
    for (int k = 0; k < 3; k++) {
        mpq_init(p[k]);
        coordinate(p[k], point, k, scale);
        expect_nearest(p[k], point->rounded[k]);
    }
    for (int i = 0; i < 4; i++) {
        const double *const own[3] = {corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]};
        exact_plane plane;
        exact_plane_set(&plane, own, scale);
        int side = side_by_fractions(own[0], own[1], own[2], p);
        assert_int_equal(exact_side(&plane, point), side);
        if (i < planes)
            assert_int_equal(side, 0);
    }
    for (int k = 0; k < 3; k++)
        mpq_clear(p[k]);
}

static void constructions(void **state) {
    (void)state;
    size_t rounds = test_rounds(2000, 200000);
    for (uint64_t round = 0; round < rounds; round++) {
        starg_rng rng = starg_rng_make(7, 0, round);
        double corner[12][3];
        int bits, range = 1 << starg_rng_below(&rng, 6), wide = (int)starg_rng_below(&rng, 4);
        for (int i = 0; i < 36; i++)
            corner[i / 3][i % 3] =
                wide == 0 ? (double)starg_rng_below(&rng, (uint64_t)range)
                          : ldexp(starg_rng_unit(&rng) - 0.5, (int)starg_rng_below(&rng, 40));
        int scale = exact_scale(corner[0], 36, &bits);
        exact_plane plane[4];
        for (int i = 0; i < 4; i++)
            exact_plane_set(
                &plane[i],
                (const double *const[]){corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]},
                scale);
        exact_point meeting, other;
        const exact_plane *three[3] = {&plane[0], &plane[1], &plane[2]};
        exact_point_of_planes(&meeting, three, scale);
        if (meeting.x[3].sign > 0)
            expect_point(&meeting, corner, 3, scale);
        if (oracle_orient3d(corner[0], corner[1], corner[2], corner[3]) !=
            oracle_orient3d(corner[0], corner[1], corner[2], corner[4])) {
            exact_point_on_plane(&other, corner[3], corner[4], &plane[0], scale);
            expect_point(&other, corner, 1, scale);
        }
    }
}

/* ---- triangulations ---- */

enum { SPAN = 8, MOST_SEGMENTS = 12 };

typedef struct drawing {
    exact_points set;
    triangulation t;
    double end[2 * MOST_SEGMENTS][3], above[MOST_SEGMENTS][3];
    uint32_t point[2 * MOST_SEGMENTS];
    size_t count;
} drawing;

static uint32_t add_point(drawing *d, const double p[3]) {
    exact_point own;
    uint32_t number;
    exact_point_set(&own, p, d->set.scale);
    test_ok(d->set.context, exact_points_add(&d->set, &own, &number));
    return number;
}

static int turn_of(const drawing *d, uint32_t a, uint32_t b, uint32_t c) {
    return exact_points_turn(&d->set, a, b, c, 0, 1);
}

/* All triangles are counter-clockwise, twins are mutual, the area is that of the enclosing
 * triangle, their number is correct, and no edge crosses a segment. */
static void expect_triangulation(const drawing *d) {
    const planar *t = &d->t.mesh;
    size_t triangles = t->corner.count / 3, points = d->t.used.count;
    assert_int_equal(triangles, 2 * points - 5);
    for (uint32_t h = 0; h < t->corner.count; h++) {
        uint32_t a = t->corner.data[h], b = t->corner.data[corner_next(h)], g = t->twin.data[h];
        assert_int_equal(turn_of(d, a, b, t->corner.data[corner_previous(h)]), 1);
        if (g != PLANAR_NONE) {
            assert_int_equal(t->twin.data[g], h);
            assert_int_equal(t->corner.data[g], b);
            assert_int_equal(t->corner.data[corner_next(g)], a);
        }
        for (size_t i = 0; i < d->count; i++) {
            uint32_t p = d->point[2 * i], q = d->point[2 * i + 1];
            assert_false(turn_of(d, a, b, p) * turn_of(d, a, b, q) < 0 &&
                         turn_of(d, p, q, a) * turn_of(d, p, q, b) < 0);
        }
    }
}

static void draw(starg_context *context, uint64_t round) {
    drawing d = {.set = {.context = context}};
    starg_rng rng = starg_rng_make(8, 0, round);
    const double around[3][3] = {{-SPAN, -SPAN, 0}, {4 * SPAN, -SPAN, 0}, {-SPAN, 4 * SPAN, 0}};
    const double face[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t enclosing[3];
    d.t = triangulation_make(&d.set);
    d.count = 1 + (size_t)starg_rng_below(&rng, MOST_SEGMENTS);
    for (int i = 0; i < 3; i++)
        enclosing[i] = add_point(&d, around[i]);
    const double *const plane[3] = {face[0], face[1], face[2]};
    test_ok(context, triangulation_begin(&d.t, plane, 0, 1, enclosing));
    for (size_t i = 0; i < d.count; i++) {
        do
            for (size_t k = 0; k < 4; k++)
                d.end[2 * i + k / 2][k % 2] = (double)starg_rng_below(&rng, SPAN);
        while (d.end[2 * i][0] == d.end[2 * i + 1][0] && d.end[2 * i][1] == d.end[2 * i + 1][1]);
        for (size_t k = 2 * i; k < 2 * i + 2; k++) {
            d.point[k] = add_point(&d, d.end[k]);
            test_ok(context, triangulation_insert(&d.t, d.point[k]));
        }
        /* alternately a line through its ends and the vertical plane through it */
        memcpy(d.above[i], (const double[]){d.end[2 * i][0], d.end[2 * i][1], 1},
               sizeof d.above[i]);
        triangulation_carrier carrier = {
            {d.end[2 * i], d.end[2 * i + 1], starg_rng_below(&rng, 2) ? d.above[i] : NULL}};
        test_ok(context,
                triangulation_constrain(&d.t, d.point[2 * i], d.point[2 * i + 1], carrier));
    }
    expect_triangulation(&d);
    test_ok(context, triangulation_improve(&d.t));
    expect_triangulation(&d);
    triangulation_free(&d.t);
    exact_points_free(&d.set);
}

static void triangulations(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t rounds = test_rounds(1500, 50000);
    for (uint64_t round = 0; round < rounds; round++)
        draw(context, round);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(constructions),
                                       cmocka_unit_test(triangulations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
