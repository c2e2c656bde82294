/* SPDX-License-Identifier: Apache-2.0 */
/* Polygon triangulation. The checker does not use ears: positive triangles whose areas add up to
 * the polygon's area, and whose edges cancel to its boundary, cannot overlap. */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/rng.h"
#include "geometry/predicates.h"
#include "mesh/formats/io.h"
#include "support.h"

enum { MOST = 300 };

typedef struct test_polygon {
    size_t count;
    double vertices[MOST][3];
    uint32_t corners[MOST];
    uint32_t triangles[3 * MOST];
} test_polygon;

static double signed_area(const test_polygon *p, const uint32_t *corners, size_t count, int u,
                          int v) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const double *a = p->vertices[corners[i]], *b = p->vertices[corners[(i + 1) % count]];
        sum += (a[u] * b[v] - a[v] * b[u]) / 2;
    }
    return sum;
}

static bool cut(starg_context *context, test_polygon *p) {
    for (size_t i = 0; i < p->count; i++)
        p->corners[i] = (uint32_t)i;
    if (starg_polygon_fan(p->vertices[0], p->corners, p->count, p->triangles))
        return true;
    test_ok(context,
            starg_polygon_clip(context, p->vertices[0], p->corners, p->count, p->triangles));
    return false;
}

/* Directed edges of all triangles, summed: one along each side of the polygon, none inside. */
static void expect_boundary(const test_polygon *p) {
    static int balance[MOST][MOST];
    memset(balance, 0, sizeof balance);
    for (size_t t = 0; t < p->count - 2; t++) {
        for (size_t k = 0; k < 3; k++) {
            uint32_t a = p->triangles[3 * t + k], b = p->triangles[3 * t + (k + 1) % 3];
            assert_true(a < p->count && b < p->count);
            balance[a][b]++;
            balance[b][a]--;
        }
    }
    for (size_t a = 0; a < p->count; a++)
        for (size_t b = 0; b < p->count; b++)
            assert_int_equal(balance[a][b], (b == (a + 1) % p->count) - (a == (b + 1) % p->count));
}

static void expect_triangulation(const test_polygon *p, int u, int v) {
    expect_boundary(p);
    double sum = 0, whole = signed_area(p, p->corners, p->count, u, v);
    for (size_t t = 0; t < p->count - 2; t++) {
        const uint32_t *c = p->triangles + 3 * t;
        assert_int_equal(orient2d(p->vertices[c[0]], p->vertices[c[1]], p->vertices[c[2]], u, v),
                         whole > 0 ? 1 : -1);
        sum += signed_area(p, c, 3, u, v);
    }
    assert_true(fabs(sum - whole) <= 1e-9 * fabs(whole));
}

/* A random star polygon around a centre, hence simple, with deep dents; in the plane of u and v,
 * slightly tilted. */
static void make_random(test_polygon *p, starg_rng *rng, int u, int v, bool clockwise) {
    int w = 3 - u - v;
    p->count = 4 + (size_t)starg_rng_below(rng, MOST - 4);
    for (size_t i = 0; i < p->count; i++) {
        double angle = 6.283185307179586 * (double)i / (double)p->count * (clockwise ? -1 : 1);
        double radius = 0.05 + starg_rng_unit(rng);
        p->vertices[i][u] = 3 + radius * cos(angle);
        p->vertices[i][v] = -7 + radius * sin(angle);
        p->vertices[i][w] = 0.3 * p->vertices[i][u] + 1e-3 * starg_rng_unit(rng);
    }
}

static void random_polygons(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(5, 0, 0);
    static test_polygon p;
    for (int round = 0; round < 400; round++) {
        int u = (int)starg_rng_below(&rng, 3);
        int v = (u + 1 + (int)starg_rng_below(&rng, 2)) % 3;
        make_random(&p, &rng, u, v, round % 2);
        cut(context, &p);
        expect_triangulation(&p, u, v);
    }
    test_context_free(context);
}

/* A strip that winds five times around the origin: nearly every triangle blocks some ear. */
static void spirals(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static test_polygon p = {.count = MOST};
    for (size_t i = 0; i < MOST; i++) {
        bool inner = i >= MOST / 2;
        double t = (double)(inner ? MOST - 1 - i : i) / (MOST / 2);
        double angle = 31 * t, radius = (inner ? 1 : 1.1) + 2 * t;
        p.vertices[i][1] = radius * cos(angle);
        p.vertices[i][2] = radius * sin(angle);
    }
    assert_false(cut(context, &p));
    expect_triangulation(&p, 1, 2);
    test_context_free(context);
}

/* The outline of a walk in unit steps north, east, south and west. */
static void walk(test_polygon *p, const char *text) {
    double x = 0, y = 0;
    p->count = strlen(text);
    for (size_t i = 0; i < p->count; i++) {
        p->vertices[i][0] = x;
        p->vertices[i][1] = y;
        p->vertices[i][2] = 5;
        x += (text[i] == 'E') - (text[i] == 'W');
        y += (text[i] == 'N') - (text[i] == 'S');
    }
    assert_true(x == 0 && y == 0);
}

static void lattice_polygons(void **state) {
    (void)state;
    static const char *const walks[] = {
        "EENNWWSS",                     /* a square with corners in the middle of its sides */
        "WWSSEENN",                     /* the same from another corner */
        "EEENWWNEENWWWSSS",             /* a C */
        "ENESENESENNNWWWWWSSS",         /* a comb */
        "EEEEENNNNNWWWWWSSSEENESSWWWS", /* a hook */
    };
    starg_context *context = test_context(1);
    static test_polygon p;
    for (size_t i = 0; i < sizeof walks / sizeof walks[0]; i++) {
        walk(&p, walks[i]);
        cut(context, &p);
        expect_triangulation(&p, 0, 1);
    }
    test_context_free(context);
}

/* A square with a square hole, joined by a bridge: two pairs of corners coincide. */
static void a_bridge_to_a_hole(void **state) {
    (void)state;
    static const double outline[10][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0},
                                          {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}};
    starg_context *context = test_context(1);
    static test_polygon p;
    p.count = 10;
    for (size_t i = 0; i < p.count; i++) {
        p.vertices[i][0] = outline[i][0];
        p.vertices[i][1] = 0;
        p.vertices[i][2] = outline[i][1];
    }
    assert_false(cut(context, &p));
    expect_triangulation(&p, 0, 2);
    test_context_free(context);
}

/* Any shape: collinear, in one point, self-intersecting, tiny and huge. */
static void polygons_without_a_triangulation_keep_their_boundary(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_rng rng = starg_rng_make(9, 0, 0);
    static test_polygon p;
    static const double scales[] = {0, 1e-300, 1, 9e99};
    for (int round = 0; round < 400; round++) {
        p.count = 4 + (size_t)starg_rng_below(&rng, 40);
        double scale = scales[round % 4];
        bool line = round % 3 == 0;
        for (size_t i = 0; i < p.count; i++)
            for (int k = 0; k < 3; k++)
                p.vertices[i][k] =
                    line && k > 0 ? p.vertices[i][0] : scale * (double)starg_rng_below(&rng, 5) / 5;
        cut(context, &p);
        expect_boundary(&p);
    }
    test_context_free(context);
}

/* A convex quadrilateral is a fan from its first corner; a concave one gets the other diagonal. */
static void quadrilaterals(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static test_polygon p = {.count = 4, .vertices = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}};
    assert_true(cut(context, &p));
    static const uint32_t fan[] = {0, 1, 2, 0, 2, 3};
    assert_memory_equal(p.triangles, fan, sizeof fan);
    p.vertices[3][0] = 1.5; /* now an arrowhead with its notch at the last corner */
    p.vertices[3][1] = 0.5;
    assert_false(cut(context, &p));
    expect_triangulation(&p, 0, 1);
    test_context_free(context);
}

static void tiny_and_huge_polygons(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static test_polygon p = {.count = 4};
    static const double scales[] = {1e-300, 1e-160, 1, 4e99};
    static const double arrow[4][2] = {{0, 0}, {2, 0}, {2, 2}, {1.5, 0.5}};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            p.vertices[k][1] = scales[i] * arrow[k][0];
            p.vertices[k][2] = scales[i] * arrow[k][1];
        }
        assert_false(cut(context, &p));
        expect_boundary(&p);
        for (size_t t = 0; t < 2; t++) {
            const uint32_t *c = p.triangles + 3 * t;
            assert_int_equal(orient2d(p.vertices[c[0]], p.vertices[c[1]], p.vertices[c[2]], 1, 2),
                             1);
        }
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_polygons),
        cmocka_unit_test(spirals),
        cmocka_unit_test(lattice_polygons),
        cmocka_unit_test(a_bridge_to_a_hole),
        cmocka_unit_test(quadrilaterals),
        cmocka_unit_test(tiny_and_huge_polygons),
        cmocka_unit_test(polygons_without_a_triangulation_keep_their_boundary),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
