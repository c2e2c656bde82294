/* SPDX-License-Identifier: Apache-2.0 */
/* Guards that look in one direction: viewing cones against their definition, and end to end. */
#include "support.h"

#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "models.h"
#include "starguard/guard.h"

enum { POINTS = 12 };

/* Points inside, some of them repeated consecutively, with directions to vertices, along axes and
 * at random: cases with ties of cosines. */
static void pick_views(const starg_solid *solid, double *points, double *directions) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    starg_rng rng = starg_rng_make(3, 1, 4);
    for (size_t i = 0; i < POINTS; i++) {
        double *p = points + 3 * i, *d = directions + 3 * i;
        do {
            for (size_t k = 0; k < 3; k++)
                p[k] = lower[k] + (upper[k] - lower[k]) * starg_rng_unit(&rng);
        } while (!starg_solid_contains(solid, p));
        if (i % 4 >= 2)
            memcpy(p, p - 3, 3 * sizeof *p);
        size_t target = starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        for (size_t k = 0; k < 3; k++)
            d[k] = i % 4 == 0   ? v[3 * target + k] - p[k]
                   : i % 4 == 1 ? (double)(k == i % 3)
                                : starg_rng_unit(&rng) - 0.5;
    }
}

/* A row with a cone contains what the row without one contains, restricted to the cone. */
static void check_rows(starg_context *context, const starg_solid *solid,
                       starg_visibility_options options, const double *points) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    starg_bits *narrow = NULL, *wide = NULL;
    bool vertices = options.target == STARG_TARGET_VERTICES;
    test_ok(context, starg_visibility(context, solid, points, POINTS, &options, &narrow));
    double cosine = starg_cone_cosine(options.cone);
    const double *directions = options.directions;
    options.cone = 360;
    options.directions = NULL;
    test_ok(context, starg_visibility(context, solid, points, POINTS, &options, &wide));
    size_t inside = 0, outside = 0;
    for (size_t i = 0; i < POINTS; i++)
        for (size_t j = 0; j < starg_bits_columns(wide); j++) {
            bool within = true;
            for (size_t k = 0; k < (vertices ? 1u : 3u); k++) {
                size_t corner = vertices ? j : starg_mesh_faces(mesh)[3 * j + k];
                within = within && oracle_compare_cone(points + 3 * i, directions + 3 * i, cosine,
                                                       v + 3 * corner) >= 0;
            }
            bool expected = within && starg_bits_test(wide, i, j);
            assert_int_equal(starg_bits_test(narrow, i, j), expected);
            inside += expected;
            outside += starg_bits_test(wide, i, j) && !expected;
        }
    assert_true(inside > 0 && outside > 0);
    starg_bits_free(narrow);
    starg_bits_free(wide);
}

static void test_rows(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "gallery", 500);
    double points[3 * POINTS], directions[3 * POINTS];
    pick_views(solid, points, directions);
    const double cones[] = {40, 90, 180, 250};
    for (size_t c = 0; c < sizeof cones / sizeof *cones; c++)
        for (int what = 0; what < 3; what++) {
            starg_visibility_options options;
            starg_visibility_options_default(&options);
            options.cone = cones[c];
            options.directions = directions;
            options.target = what == 0 ? STARG_TARGET_VERTICES : STARG_TARGET_FACES;
            options.face_rule = what == 2 ? STARG_FACES_WHOLE : STARG_FACES_VERTICES;
            if (what < 2 || cones[c] <= 180)
                check_rows(context, solid, options, points);
        }
    starg_solid_free(solid);
    test_context_free(context);
}

/* Is the only row of `one` equal to a row of `others`? Returns how much it holds. */
static size_t check_row(const starg_bits *one, const starg_bits *others, size_t row) {
    size_t seen = 0;
    for (size_t j = 0; j < starg_bits_columns(one); j++) {
        assert_int_equal(starg_bits_test(others, row, j), starg_bits_test(one, 0, j));
        seen += starg_bits_test(one, 0, j);
    }
    return seen;
}

/* A place that looks in one direction only is asked for no more than that view; where another
 * stands there too, both look among what is seen all around. */
static void test_one_view(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "gallery", 3000);
    double points[3 * POINTS], directions[3 * POINTS], twice[6 * POINTS], ways[6 * POINTS];
    pick_views(solid, points, directions);
    for (size_t i = 0; i < 3 * POINTS; i++) {
        twice[6 * (i / 3) + i % 3] = twice[6 * (i / 3) + 3 + i % 3] = points[i];
        ways[6 * (i / 3) + i % 3] = directions[i];
        ways[6 * (i / 3) + 3 + i % 3] = -directions[i];
    }
    const double views[][3] = {{0, 0, 30}, {0, 0, 170}, {90, 60, 360}, {20, 150, 360}};
    for (size_t c = 0; c < sizeof views / sizeof *views; c++) {
        size_t seen = 0;
        starg_bits *one = NULL, *both = NULL;
        starg_visibility_options options;
        starg_visibility_options_default(&options);
        memcpy(options.fov, views[c], sizeof options.fov);
        options.cone = views[c][2];
        for (size_t i = 0; i < POINTS; i++) {
            options.directions = directions + 3 * i;
            test_ok(context, starg_visibility(context, solid, points + 3 * i, 1, &options, &one));
            options.directions = ways + 6 * i;
            test_ok(context, starg_visibility(context, solid, twice + 6 * i, 2, &options, &both));
            seen += check_row(one, both, 0);
            starg_bits_free(one);
            starg_bits_free(both);
        }
        assert_true(seen > 0);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

/* Places that return after others have been looked at, or left out: what one view was asked for is
 * not taken for what the place sees all around. */
static void test_views_apart(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "gallery", 3000);
    double points[3 * POINTS], directions[3 * POINTS];
    size_t seen = 0;
    pick_views(solid, points, directions);
    starg_visibility_options options;
    starg_visibility_options_default(&options);
    options.cone = 60;
    for (size_t i = 0; i < POINTS; i++) {
        const double *p = points + 3 * i, *d = directions + 3 * i;
        const double places[9] = {p[0], p[1], p[2], 1e6, 1e6, 1e6, p[0], p[1], p[2]};
        const double ways[9] = {-d[0], -d[1], -d[2], 1, 0, 0, d[0], d[1], d[2]};
        starg_bits *one = NULL, *three = NULL;
        options.directions = d;
        test_ok(context, starg_visibility(context, solid, p, 1, &options, &one));
        options.directions = ways;
        test_ok(context, starg_visibility(context, solid, places, 3, &options, &three));
        seen += check_row(one, three, 2);
        starg_bits_free(one);
        starg_bits_free(three);
    }
    assert_true(seen > 0);
    starg_solid_free(solid);
    test_context_free(context);
}

static void test_bad_cones(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "sphere", 500);
    const double point[3] = {0, 0, 0}, zero[3] = {0, 0, 0}, endless[3] = {INFINITY, 0, 0};
    const double forward[3] = {1, 0, 0};
    const struct {
        double cone;
        const double *direction;
        starg_face_rule rule;
    } bad[] = {{0, forward, STARG_FACES_VERTICES},   {-5, forward, STARG_FACES_VERTICES},
               {361, forward, STARG_FACES_VERTICES}, {NAN, forward, STARG_FACES_VERTICES},
               {90, NULL, STARG_FACES_VERTICES},     {90, zero, STARG_FACES_VERTICES},
               {90, endless, STARG_FACES_VERTICES},  {200, forward, STARG_FACES_WHOLE}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        starg_visibility_options options;
        starg_bits *rows = NULL;
        starg_visibility_options_default(&options);
        options.cone = bad[i].cone;
        options.directions = bad[i].direction;
        options.face_rule = bad[i].rule;
        assert_int_equal(starg_visibility(context, solid, point, 1, &options, &rows),
                         STARG_ERROR_ARGUMENT);
        assert_null(rows);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

/* Limits that cannot be met, or exclude each other. */
static void test_bad_limits(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "sphere", 500);
    const double point[3] = {0, 0, 0}, forward[3] = {1, 0, 0}, endless[3] = {0, NAN, 0};
    starg_visibility_options good;
    starg_visibility_options_default(&good);
    good.directions = forward;
    starg_visibility_options bad[11];
    for (size_t i = 0; i < 11; i++)
        bad[i] = good;
    bad[0].fov[0] = 90;
    bad[1].fov[0] = bad[1].fov[1] = 180;
    bad[2].fov[0] = bad[2].fov[1] = -5;
    bad[3].fov[0] = bad[3].fov[1] = 60;
    bad[3].cone = 90;
    bad[4].fov[0] = bad[4].fov[1] = 60;
    bad[4].directions = NULL;
    bad[5].fov[0] = bad[5].fov[1] = 60;
    bad[5].ups = endless;
    bad[6].near = 2;
    bad[6].range = 1;
    bad[7].near = -1;
    bad[8].incidence = -1;
    bad[9].incidence = 100;
    bad[10].incidence = 60;
    bad[10].target = STARG_TARGET_VERTICES;
    for (size_t i = 0; i < 11; i++) {
        starg_bits *rows = NULL;
        assert_int_equal(starg_visibility(context, solid, point, 1, &bad[i], &rows),
                         STARG_ERROR_ARGUMENT);
        assert_null(rows);
    }
    starg_solid_free(solid);
    test_context_free(context);
}

/* Planes of a view along x with z up: 45 degrees to the left and right, 30 up and down; and what is
 * up does not matter where it lies along the direction. */
static void test_frustum(void **state) {
    (void)state;
    const double x[3] = {1, 0, 0}, z[3] = {0, 0, 2}, fov[2] = {90, 60};
    double planes[4][3];
    starg_frustum(x, z, fov, planes);
    const double expected[4][3] = {{sqrt(0.5), -sqrt(0.5), 0},
                                   {sqrt(0.5), sqrt(0.5), 0},
                                   {0.5, 0, sqrt(0.75)},
                                   {0.5, 0, -sqrt(0.75)}};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            assert_true(fabs(planes[i][k] - expected[i][k]) < 1e-15);
    starg_frustum(z, z, fov, planes);
    for (int i = 0; i < 4; i++) {
        double length = hypot(hypot(planes[i][0], planes[i][1]), planes[i][2]);
        assert_true(fabs(length - 1) < 1e-15 && planes[i][2] > 0);
    }
}

/* Two guards that see a face from one side of it are no pair; where candidates allow, all faces
 * have one, and the bound is still that of seeing each twice. */
static void test_baseline(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "gallery", 500);
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 100;
    options.redundancy = 2;
    options.method = STARG_GUARD_ILP;
    starg_guards *twice = test_guard(context, solid, &options);
    options.baseline = 40;
    starg_guards *apart = test_guard(context, solid, &options);
    assert_int_equal(apart->lower_bound, twice->lower_bound);
    assert_true(apart->count > twice->count);
    assert_true(apart->baseline_faces > apart->face_count * 9 / 10);
    starg_guards_free(context, twice);
    starg_guards_free(context, apart);
    options.redundancy = 1;
    assert_int_equal(starg_guard(context, solid, &options, &apart), STARG_ERROR_ARGUMENT);
    options.redundancy = 2;
    options.coverage = 0.9;
    assert_int_equal(starg_guard(context, solid, &options, &apart), STARG_ERROR_ARGUMENT);
    starg_solid_free(solid);
    test_context_free(context);
}

/* The narrower the view, the more guards; all of them look somewhere. From anywhere in a ball,
 * a cone of less than 90 degrees sees less than half of its surface, so that two are not enough. */
static void test_guards_with_cones(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    starg_solid *solid = test_sample(context, "sphere", 500);
    const double cones[] = {360, 180, 80};
    const int methods[] = {STARG_GUARD_PILP, STARG_GUARD_ILP, STARG_GUARD_GREEDY};
    for (size_t m = 0; m < 3; m++) {
        size_t before = 0;
        for (size_t c = 0; c < 3; c++) {
            starg_guard_options options;
            starg_guard_options_default(&options);
            options.method = (starg_guard_method)methods[m];
            options.candidate_count = 20;
            options.max_nodes = 20;
            options.refine_lines = 100000;
            options.visibility.cone = cones[c];
            starg_guards *guards = test_guard(context, solid, &options);
            assert_int_equal(guards->uncovered_count, 0);
            assert_true(guards->count > before);
            assert_int_equal(guards->directions != NULL, cones[c] < 360);
            before = guards->count;
            starg_guards_free(context, guards);
        }
    }
    starg_solid_free(solid);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows),       cmocka_unit_test(test_bad_cones),
        cmocka_unit_test(test_bad_limits), cmocka_unit_test(test_frustum),
        cmocka_unit_test(test_baseline),   cmocka_unit_test(test_guards_with_cones),
        cmocka_unit_test(test_one_view),   cmocka_unit_test(test_views_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
