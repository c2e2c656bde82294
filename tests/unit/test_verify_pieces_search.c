/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier's search tree and its table of facets against brute force. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adversarial.h"
#include "core/memory.h"
#include "cut.h"
#include "support.h"
#include "verify/pieces.h"
#include "verify/signs.h"
#include "verify/surface.h"

/* ---- the search tree ---- */

typedef struct tally {
    uint8_t *visited;
    size_t count;
} tally;

static bool visit(void *data, uint32_t face) {
    tally *own = data;
    own->count++;
    assert_int_equal(own->visited[face]++, 0);
    return true;
}

static bool box_meets(const double lower[3], const double upper[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++)
        if (fmax(fmax(t[0][k], t[1][k]), t[2][k]) < lower[k] ||
            fmin(fmin(t[0][k], t[1][k]), t[2][k]) > upper[k])
            return false;
    return true;
}

static void compare_boxes(const verify_surface *surface, const verify_tree *tree, const double p[3],
                          const double q[3]) {
    double lower[3], upper[3];
    for (int k = 0; k < 3; k++) {
        lower[k] = fmin(p[k], q[k]);
        upper[k] = fmax(p[k], q[k]);
    }
    tally own = {calloc(surface->face_count, 1), 0};
    verify_tree_visit(tree, lower, upper, visit, &own);
    for (size_t f = 0; f < surface->face_count; f++) {
        const double *t[3];
        verify_corners(surface, f, t);
        assert_int_equal(own.visited[f], box_meets(lower, upper, t));
    }
    free(own.visited);
}

/* Random triangles on random points of every family. */
static void test_tree(void **state) {
    (void)state;
    enum { FACES = 60, POINTS = 24, ROUNDS = 25 };
    starg_context *context = test_context(1);
    size_t blocked = 0, free_lines = 0;
    for (int family = 0; family < POINT_FAMILIES; family++)
        for (uint64_t round = 0; round < ROUNDS; round++) {
            starg_rng rng = starg_rng_make(31, (uint64_t)family, round);
            double x[POINTS][3];
            uint32_t *faces = starg_allocate(context, 3 * (size_t)FACES, sizeof *faces);
            size_t count = round == 0 ? 0 : (size_t)starg_rng_below(&rng, FACES) + 1;
            adversarial_points(&rng, (point_family)family, x, POINTS);
            for (size_t i = 0; i < 3 * count; i++)
                faces[i] = (uint32_t)starg_rng_below(&rng, POINTS);
            verify_surface *surface = NULL;
            verify_tree *tree = NULL;
            test_ok(context, verify_surface_wrap(context, x[0], POINTS, faces, count, &surface));
            test_ok(context, verify_tree_create(surface, &tree));
            for (int i = 0; i < POINTS; i++) {
                const double *p = x[i], *q = x[starg_rng_below(&rng, POINTS)];
                int scale = verify_scale(surface);
                bool on = false, blocks = false;
                for (size_t f = 0; f < count; f++) {
                    const double *t[3];
                    verify_corners(surface, f, t);
                    on = on || verify_on_triangle(p, t);
                    blocks = blocks || verify_blocks(p, q, t);
                }
                if (!on) {
                    assert_int_equal(verify_tree_blocks(tree, p, q), blocks);
                    blocked += blocks;
                    free_lines += !blocks;
                }
                compare_boxes(surface, tree, p, q);
                double near = verify_distance(surface, p, surface->face_count, scale);
                double found = verify_tree_distance(tree, p, scale);
                assert_true(near == found || fabs(near - found) <= ldexp(1e-12, -scale));
            }
            verify_tree_free(tree);
            verify_surface_free(surface);
        }
    assert_true(blocked > 100 && free_lines > 100);
    test_context_free(context);
}

/* Winding numbers with and without the tree; corners, lattice points and points between. */
static void test_tree_winding(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    size_t inside = 0, outside = 0, on = 0;
    for (int which = 0; which < 4; which++) {
        shape s = which == 0   ? shape_cavity()
                  : which == 1 ? shape_columns()
                  : which == 2 ? shape_blob(2, 3)
                               : shape_cube(2);
        const double nearby[3] = {0.5, 0.25, 0.125};
        if (which == 3) { /* two nested ones: winding numbers up to 2 */
            shape other = shape_cube(2);
            shape_append(&s, &other, nearby, 0);
            shape_free(&other);
        }
        uint32_t *faces = starg_allocate(context, 3 * s.face_count, sizeof *faces);
        memcpy(faces, s.faces, 3 * s.face_count * sizeof *faces);
        verify_surface *surface = NULL;
        verify_tree *tree = NULL;
        test_ok(context, verify_surface_wrap(context, s.vertices, s.vertex_count, faces,
                                             s.face_count, &surface));
        test_ok(context, verify_tree_create(surface, &tree));
        for (uint64_t round = 0; round < 600; round++) {
            starg_rng rng = starg_rng_make(43, (uint64_t)which, round);
            double p[3];
            bool expected_on, found_on;
            for (int k = 0; k < 3; k++)
                p[k] = round % 2 ? 4 * starg_rng_unit(&rng) - 0.5
                                 : (double)starg_rng_below(&rng, 9) / 2 - 0.5;
            int expected = verify_winding(surface, NULL, s.face_count, p, &expected_on);
            assert_int_equal(verify_tree_winding(tree, p, &found_on), expected);
            assert_int_equal(found_on, expected_on);
            inside += expected > 0;
            outside += expected == 0 && !expected_on;
            on += expected_on;
        }
        verify_tree_free(tree);
        verify_surface_free(surface);
        shape_free(&s);
    }
    assert_true(inside > 100 && outside > 100 && on > 100);
    test_context_free(context);
}

/* ---- facets ---- */

/* Random tetrahedra on few vertices: mates are unique, mutual and opposite; every triangle without
 * misuse is matched exactly if it occurs twice. */
static void test_facets(void **state) {
    (void)state;
    enum { MOST = 40 };
    starg_context *context = test_context(1);
    size_t mated = 0, misused = 0;
    for (uint64_t round = 0; round < 300; round++) {
        starg_rng rng = starg_rng_make(37, round, 0);
        static cut c;
        memset(&c, 0, sizeof c);
        size_t vertices = 4 + (size_t)starg_rng_below(&rng, 12);
        size_t count = 1 + (size_t)starg_rng_below(&rng, MOST);
        while (c.mesh.count < count) {
            uint32_t v[4];
            for (int i = 0; i < 4; i++)
                v[i] = (uint32_t)starg_rng_below(&rng, vertices);
            if (v[0] != v[1] && v[0] != v[2] && v[0] != v[3] && v[1] != v[2] && v[1] != v[3] &&
                v[2] != v[3])
                cut_add_tetrahedron(&c, v[0], v[1], v[2], v[3], 0);
        }
        verify_facets *facets = NULL;
        test_ok(context, verify_facets_create(context, c.tetrahedra, count, &facets));
        size_t wrong = 0;
        for (uint32_t f = 0; f < 4 * count; f++) {
            uint32_t a[3], b[3], same = 0, other = 0, mate = facets->mate[f];
            cut_side(&c, f / 4, (int)(f % 4), a);
            for (uint32_t g = 0; g < 4 * count; g++) {
                cut_side(&c, g / 4, (int)(g % 4), b);
                const uint32_t turned[3] = {b[0], b[2], b[1]};
                other += cut_opposite(a, b);
                same += cut_opposite(a, turned);
            }
            wrong += same > 1 || other > 1;
            if (same == 1 && other <= 1)
                assert_int_equal(mate != VERIFY_NONE, other == 1);
            if (mate == VERIFY_NONE)
                continue;
            mated++;
            cut_side(&c, mate / 4, (int)(mate % 4), b);
            assert_true(cut_opposite(a, b) && facets->mate[mate] == f);
        }
        assert_int_equal(facets->third.count + facets->same_side.count > 0, wrong > 0);
        misused += wrong > 0;
        verify_facets_free(facets);
    }
    assert_true(mated > 100 && misused > 20 && misused < 290);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tree),
        cmocka_unit_test(test_tree_winding),
        cmocka_unit_test(test_facets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
