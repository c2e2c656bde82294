/* SPDX-License-Identifier: Apache-2.0 */
/* The tree against loops over all triangles. */
#include "geometry/bvh.h"

#include <math.h>
#include <stdlib.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "geometry/intersect.h"
#include "shapes.h"
#include "support.h"

/* ---- shapes to ask about ---- */

enum { SHAPES = 8 };

static shape make_shape(int which) {
    const double nothing[3] = {0, 0, 0}, near[3] = {1, 1, 1};
    shape s, other;
    switch (which) {
    case 0:
        return shape_tetrahedron();
    case 1:
        return shape_cube(2);
    case 2:
        return shape_room();
    case 3:
        return shape_cavity();
    case 4:
        return shape_columns();
    case 5:
        s = shape_blob(2, 7);
        shape_place(&s, 2, 0);
        return s;
    case 6: /* two cubes that cross, and one turned inside out */
        s = shape_cube(2);
        other = shape_cube(2);
        shape_append(&s, &other, near, 0);
        shape_append(&s, &other, nothing, 1);
        shape_free(&other);
        return s;
    default: /* flat: every face doubled from behind */
        s = shape_tetrahedron();
        for (size_t i = 0; i < s.vertex_count; i++)
            s.vertices[3 * i + 2] = 0;
        return s;
    }
}

typedef struct scene {
    starg_context *context;
    shape s;
    bvh *tree;
} scene;

static void with_every_shape(void check(const scene *world)) {
    starg_context *context = test_context(1);
    for (int which = 0; which < SHAPES; which++) {
        scene world = {.context = context, .s = make_shape(which)};
        test_ok(context, bvh_create(context, world.s.vertices, world.s.faces, world.s.face_count,
                                    &world.tree));
        check(&world);
        bvh_free(world.tree);
        shape_free(&world.s);
    }
    test_context_free(context);
}

static const double *corner(const shape *s, size_t face, int i) {
    return s->vertices + 3 * (size_t)s->faces[3 * face + (size_t)i];
}

/* Half-integers about the shapes: corners, edges, faces and the space between. */
static void lattice_point(starg_rng *rng, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = -1 + 0.5 * (double)starg_rng_below(rng, 15);
}

/* ---- boxes ---- */

static bvh_box box_of(const shape *s, size_t face) {
    bvh_box box;
    for (int k = 0; k < 3; k++) {
        double a = corner(s, face, 0)[k], b = corner(s, face, 1)[k], c = corner(s, face, 2)[k];
        box.lower[k] = fmin(a, fmin(b, c));
        box.upper[k] = fmax(a, fmax(b, c));
    }
    return box;
}

static bool boxes_meet(const bvh_box *a, const bvh_box *b) {
    for (int k = 0; k < 3; k++)
        if (a->upper[k] < b->lower[k] || b->upper[k] < a->lower[k])
            return false;
    return true;
}

typedef struct tally {
    int *calls; /* of each triangle, or pair */
    size_t faces, total, limit;
} tally;

static bool count_triangle(void *user, uint32_t triangle) {
    tally *t = user;
    assert_true(triangle < t->faces);
    t->calls[triangle]++;
    return ++t->total != t->limit;
}

static bool count_pair(void *user, uint32_t a, uint32_t b) {
    tally *t = user;
    assert_true(a < t->faces && b < t->faces && a != b);
    t->calls[(a < b ? a : b) * t->faces + (a < b ? b : a)]++;
    return ++t->total != t->limit;
}

static void check_box(const scene *world) {
    size_t n = world->s.face_count;
    for (uint64_t round = 0; round < 100; round++) {
        starg_rng rng = starg_rng_make(13, 0, round);
        double p[3], q[3];
        lattice_point(&rng, p);
        lattice_point(&rng, q);
        bvh_box box;
        for (int k = 0; k < 3; k++) {
            box.lower[k] = fmin(p[k], q[k]);
            box.upper[k] = fmax(p[k], q[k]);
        }
        tally t = {.calls = calloc(n, sizeof(int)), .faces = n};
        assert_true(bvh_query_box(world->tree, &box, count_triangle, &t));
        size_t expected = 0;
        for (size_t f = 0; f < n; f++) {
            bvh_box own = box_of(&world->s, f);
            assert_int_equal(t.calls[f], boxes_meet(&box, &own));
            expected += boxes_meet(&box, &own);
        }
        if (expected > 1) {
            t.total = 0;
            t.limit = expected - 1;
            assert_false(bvh_query_box(world->tree, &box, count_triangle, &t));
            assert_int_equal(t.total, t.limit);
        }
        free(t.calls);
    }
}

static void test_query_box(void **state) {
    (void)state;
    with_every_shape(check_box);
}

static void check_pairs(const scene *world) {
    size_t n = world->s.face_count;
    tally t = {.calls = calloc(n * n, sizeof(int)), .faces = n};
    assert_true(bvh_query_pairs(world->tree, count_pair, &t));
    for (size_t a = 0; a < n; a++)
        for (size_t b = a + 1; b < n; b++) {
            bvh_box first = box_of(&world->s, a), second = box_of(&world->s, b);
            assert_int_equal(t.calls[a * n + b], boxes_meet(&first, &second));
        }
    t.limit = t.total - 1;
    t.total = 0;
    assert_false(bvh_query_pairs(world->tree, count_pair, &t));
    assert_int_equal(t.total, t.limit);
    free(t.calls);
}

static void test_query_pairs(void **state) {
    (void)state;
    with_every_shape(check_pairs);
}

/* ---- winding number ---- */

static void check_winding_at(const scene *world, const double p[3]) {
    bool expected_on, found_on;
    int expected =
        oracle_winding(world->s.vertices, world->s.faces, world->s.face_count, p, &expected_on);
    int found = bvh_winding(world->tree, p, &found_on);
    if (found_on != expected_on || (!expected_on && found != expected))
        fail_msg("at (%a, %a, %a): expected %d%s, found %d%s", p[0], p[1], p[2], expected,
                 expected_on ? " on" : "", found, found_on ? " on" : "");
    int sum = 0;
    for (uint32_t f = 0; f < world->s.face_count; f++)
        sum += bvh_crossing(world->tree, f, p);
    if (!expected_on)
        assert_int_equal(sum, expected);
}

static void check_winding(const scene *world) {
    for (uint64_t round = 0; round < 100; round++) {
        starg_rng rng = starg_rng_make(13, 1, round);
        double p[3];
        lattice_point(&rng, p);
        check_winding_at(world, p);
        for (int k = 0; k < 3; k++) /* and an ulp next to it */
            p[k] = nextafter(p[k], starg_rng_below(&rng, 2) ? INFINITY : -INFINITY);
        check_winding_at(world, p);
    }
    for (size_t v = 0; v < world->s.vertex_count; v++) {
        const double *q = world->s.vertices + 3 * v;
        const double above[3] = {q[0], q[1], q[2] + 0.25}, below[3] = {q[0], q[1], q[2] - 0.25};
        check_winding_at(world, q);
        check_winding_at(world, above);
        check_winding_at(world, below);
    }
}

static void test_winding(void **state) {
    (void)state;
    with_every_shape(check_winding);
}

/* ---- segments and other boxes ---- */

static bool count_rank(void *user, size_t rank) {
    tally *t = user;
    assert_true(rank < t->faces);
    t->calls[rank]++;
    return ++t->total != t->limit;
}

static bool meets(const scene *world, size_t face, const double p[3], const double q[3]) {
    const double *a = corner(&world->s, face, 0), *b = corner(&world->s, face, 1);
    const double *c = corner(&world->s, face, 2);
    return segment_meets_triangle(p, q, a, b, c) || point_on_triangle(q, a, b, c);
}

/* Every triangle that the segment meets is visited, and none twice. */
static void check_segment(const scene *world, const double p[3], const double q[3]) {
    size_t n = world->s.face_count;
    tally t = {.calls = calloc(n, sizeof(int)), .faces = n};
    assert_true(bvh_query_segment(world->tree, p, q, count_rank, &t));
    for (size_t rank = 0; rank < n; rank++) {
        size_t face = world->tree->order[rank];
        assert_true(t.calls[rank] <= 1);
        if (t.calls[rank] == 0 && meets(world, face, p, q))
            fail_msg("from (%a, %a, %a) to (%a, %a, %a): face %zu is left out", p[0], p[1], p[2],
                     q[0], q[1], q[2], face);
    }
    if (t.total > 1) {
        t.limit = t.total - 1;
        t.total = 0;
        assert_false(bvh_query_segment(world->tree, p, q, count_rank, &t));
        assert_int_equal(t.total, t.limit);
    }
    free(t.calls);
}

static void check_segments(const scene *world) {
    for (uint64_t round = 0; round < 150; round++) {
        starg_rng rng = starg_rng_make(13, 2, round);
        double p[3], q[3];
        lattice_point(&rng, p);
        lattice_point(&rng, q);
        check_segment(world, p, q);
        for (int k = 0; k < 3; k++)
            p[k] += starg_rng_unit(&rng);
        check_segment(world, p, q);
        size_t v = (size_t)starg_rng_below(&rng, world->s.vertex_count);
        check_segment(world, p, world->s.vertices + 3 * v);
    }
}

static void test_query_segment(void **state) {
    (void)state;
    with_every_shape(check_segments);
}

/* The same meshes so large and so small that products of coordinates overflow or underflow. */
static void test_query_segment_at_any_scale(void **state) {
    (void)state;
    static const double scales[] = {1e99, 1e90, 1e-160, 1e-300, 5e-324};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++)
        for (int which = 0; which < SHAPES; which++) {
            scene world = {.context = context, .s = make_shape(which)};
            shape_place(&world.s, scales[i], 0);
            test_ok(context, bvh_create(context, world.s.vertices, world.s.faces,
                                        world.s.face_count, &world.tree));
            for (uint64_t round = 0; round < 10; round++) {
                starg_rng rng = starg_rng_make(13, 4, round);
                double p[3], q[3];
                lattice_point(&rng, p);
                lattice_point(&rng, q);
                for (int k = 0; k < 3; k++) {
                    p[k] *= scales[i];
                    q[k] *= scales[i];
                }
                check_segment(&world, p, q);
                check_winding_at(&world, p);
            }
            bvh_free(world.tree);
            shape_free(&world.s);
        }
    test_context_free(context);
}

/* A custom query: everything that reaches below z = 1. */
static bool reaches_below_one(void *user, const bvh_box *box) {
    (void)user;
    return box->lower[2] < 1;
}

static void check_query(const scene *world) {
    size_t n = world->s.face_count;
    tally t = {.calls = calloc(n, sizeof(int)), .faces = n};
    assert_true(bvh_query(world->tree, reaches_below_one, &t, count_rank, &t));
    for (size_t rank = 0; rank < n; rank++) {
        bvh_box box = box_of(&world->s, world->tree->order[rank]);
        assert_true(t.calls[rank] <= 1);
        assert_true(t.calls[rank] == 1 || box.lower[2] >= 1);
    }
    free(t.calls);
}

static void test_query(void **state) {
    (void)state;
    with_every_shape(check_query);
}

/* ---- the order ---- */

static void check_order(const scene *world) {
    size_t n = world->s.face_count;
    int *calls = calloc(n, sizeof(int));
    for (size_t rank = 0; rank < n; rank++) {
        assert_true(world->tree->order[rank] < n);
        calls[world->tree->order[rank]]++;
    }
    for (size_t f = 0; f < n; f++)
        assert_int_equal(calls[f], 1);
    free(calls);
}

static void test_order_is_a_permutation(void **state) {
    (void)state;
    with_every_shape(check_order);
}

/* ---- distance: the least over corners, edges and the foot on the plane ---- */

static long double dot(const long double a[3], const long double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Squared length of v minus its projection to e, with the factor clamped to [0, 1]. */
static long double squared_from_edge(const long double v[3], const long double e[3]) {
    long double length = dot(e, e);
    long double t = length > 0 ? fminl(1, fmaxl(0, dot(v, e) / length)) : 0;
    long double rest[3] = {v[0] - t * e[0], v[1] - t * e[1], v[2] - t * e[2]};
    return dot(rest, rest);
}

static double distance_by_definition(const shape *s, size_t face, const double p[3]) {
    long double v[3][3], e[3][3], n[3], least = INFINITY;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            v[i][k] = (long double)p[k] - corner(s, face, i)[k];
            e[i][k] = (long double)corner(s, face, (i + 1) % 3)[k] - corner(s, face, i)[k];
        }
    for (int i = 0; i < 3; i++)
        least = fminl(least, squared_from_edge(v[i], e[i]));
    for (int k = 0; k < 3; k++)
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
    bool above = dot(n, n) > 0;
    for (int i = 0; i < 3; i++) { /* on the inner side of every edge, in the plane? */
        long double side[3];
        for (int k = 0; k < 3; k++)
            side[k] = e[i][(k + 1) % 3] * v[i][(k + 2) % 3] - e[i][(k + 2) % 3] * v[i][(k + 1) % 3];
        above = above && dot(side, n) >= 0;
    }
    if (above)
        least = fminl(least, dot(v[0], n) * dot(v[0], n) / dot(n, n));
    return (double)sqrtl(least);
}

static void check_distance(const scene *world) {
    for (uint64_t round = 0; round < 200; round++) {
        starg_rng rng = starg_rng_make(13, 3, round);
        double p[3], expected = INFINITY;
        lattice_point(&rng, p);
        if (round % 2 == 0)
            for (int k = 0; k < 3; k++)
                p[k] += starg_rng_unit(&rng);
        for (size_t f = 0; f < world->s.face_count; f++)
            expected = fmin(expected, distance_by_definition(&world->s, f, p));
        double found = bvh_distance(world->tree, p);
        if (!(fabs(found - expected) <= 1e-13 * (1 + expected)))
            fail_msg("at (%a, %a, %a): expected %.17g, found %.17g", p[0], p[1], p[2], expected,
                     found);
        double foot[3], off = 0, on = INFINITY;
        bvh_nearest(world->tree, p, foot);
        for (int k = 0; k < 3; k++)
            off += (foot[k] - p[k]) * (foot[k] - p[k]);
        for (size_t f = 0; f < world->s.face_count; f++)
            on = fmin(on, distance_by_definition(&world->s, f, foot));
        assert_true(fabs(sqrt(off) - expected) <= 1e-12 * (1 + expected) && on <= 1e-12);
    }
}

static void test_distance(void **state) {
    (void)state;
    with_every_shape(check_distance);
}

/* ---- the smallest trees ---- */

static bool never(void *user, uint32_t triangle) {
    (void)user;
    fail_msg("triangle %u", triangle);
    return true;
}

static bool never_rank(void *user, size_t rank) {
    (void)user;
    fail_msg("rank %zu", rank);
    return true;
}

static bool never_pair(void *user, uint32_t a, uint32_t b) {
    (void)user;
    fail_msg("pair %u %u", a, b);
    return true;
}

static void test_empty(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    bvh *tree;
    const bvh_box all = {{-1e99, -1e99, -1e99}, {1e99, 1e99, 1e99}};
    const double p[3] = {0, 0, 0}, q[3] = {1, 0, 0};
    bool on_surface = true;
    test_ok(context, bvh_create(context, NULL, NULL, 0, &tree));
    assert_true(bvh_query_box(tree, &all, never, NULL));
    assert_true(bvh_query_pairs(tree, never_pair, NULL));
    assert_int_equal(bvh_winding(tree, p, &on_surface), 0);
    assert_false(on_surface);
    assert_true(bvh_query_segment(tree, p, q, never_rank, NULL));
    assert_true(isinf(bvh_distance(tree, p)) && bvh_distance(tree, p) > 0);
    bvh_free(tree);
    bvh_free(NULL);
    test_context_free(context);
}

static void test_one_triangle(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    const double vertices[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
    const uint32_t face[3] = {0, 1, 2};
    const double above[3] = {1, 1, 2}, below[3] = {1, 1, -2}, aside[3] = {9, 9, 2};
    const double on[3] = {2, 2, 0};
    const bvh_box touching = {{4, 0, 0}, {5, 1, 1}}, beside = {{4.5, 0, 0}, {5, 1, 1}};
    bvh *tree;
    bool on_surface;
    int calls[1] = {0};
    tally t = {.calls = calls, .faces = 1};
    test_ok(context, bvh_create(context, vertices, face, 1, &tree));
    assert_true(bvh_query_box(tree, &touching, count_triangle, &t));
    assert_int_equal(calls[0], 1);
    assert_true(bvh_query_box(tree, &beside, never, NULL));
    assert_true(bvh_query_pairs(tree, never_pair, NULL));
    assert_true(bvh_query_segment(tree, above, below, count_rank, &t));
    assert_int_equal(calls[0], 2);
    assert_true(bvh_query_segment(tree, above, aside, never_rank, NULL));
    bvh_winding(tree, on, &on_surface);
    assert_true(on_surface);
    bvh_winding(tree, above, &on_surface);
    assert_false(on_surface);
    assert_true(bvh_distance(tree, above) == 2);
    bvh_free(tree);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_query_box),
        cmocka_unit_test(test_query_pairs),
        cmocka_unit_test(test_winding),
        cmocka_unit_test(test_query_segment),
        cmocka_unit_test(test_query_segment_at_any_scale),
        cmocka_unit_test(test_query),
        cmocka_unit_test(test_order_is_a_permutation),
        cmocka_unit_test(test_distance),
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_one_triangle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
