/* SPDX-License-Identifier: Apache-2.0 */
/* Every engine against visibility by definition, on small solids and points designed to break them:
 * lattices, coplanar and cospherical faces, nested shells, slivers, self-intersection, and points
 * in the planes of faces and of edges or an ulp off. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/visibility.h"
#include "visibility_oracle.h"

enum { POINTS = 12, WHOLE_POINTS = 1 };

/* Five kinds of points, cyclically: anywhere; on the half-lattice; means of two and of three
 * vertices; and on the line of an edge, some moved by an ulp. Keeps those inside. */
static size_t pick_points(const starg_solid *solid, uint64_t seed, double *points) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    double lower[3], upper[3];
    size_t count = 0;
    starg_mesh_bounds(mesh, lower, upper);
    for (uint64_t attempt = 0; attempt < 2000 && count < POINTS; attempt++) {
        starg_rng rng = starg_rng_make(seed, 3, attempt);
        const double *a = v + 3 * starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        const double *b = v + 3 * starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        const double *c = v + 3 * starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        const uint32_t *face = f + 3 * starg_rng_below(&rng, starg_mesh_face_count(mesh));
        double p[3], along = (double)starg_rng_below(&rng, 5) - 1.5;
        for (size_t k = 0; k < 3; k++) {
            double from = v[3 * (size_t)face[0] + k], to = v[3 * (size_t)face[1] + k];
            double random = lower[k] + (upper[k] - lower[k]) * starg_rng_unit(&rng);
            double kinds[] = {random, 0.5 * round(2 * random), 0.5 * (a[k] + b[k]),
                              (a[k] + b[k] + c[k]) / 3, from + along * (to - from)};
            p[k] = kinds[attempt % 5];
            if (starg_rng_below(&rng, 8) == 0)
                p[k] = nextafter(p[k], starg_rng_below(&rng, 2) ? INFINITY : -INFINITY);
        }
        if (starg_solid_contains(solid, p))
            memcpy(points + 3 * count++, p, sizeof p);
    }
    return count;
}

static void compare(const char *name, const char *engine, const starg_bits *bits, size_t point,
                    const bool *expected) {
    for (size_t j = 0; j < starg_bits_columns(bits); j++)
        if (starg_bits_test(bits, point, j) != expected[j]) {
            print_error("%s, %s, point %zu: column %zu is %d, by definition %d\n", name, engine,
                        point, j, !expected[j], expected[j]);
            fail();
        }
}

/* Vertices and whole faces; the other rule follows from the vertices. */
static void check_solid(starg_context *context, const char *name, const starg_solid *solid,
                        uint64_t seed) {
    static const char *const engines[] = {"grid", "bvh", "sweep", "contours", "fastest"};
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    size_t n = starg_mesh_vertex_count(mesh), m = starg_mesh_face_count(mesh);
    double points[3 * POINTS];
    size_t count = pick_points(solid, seed, points),
           few = count < WHOLE_POINTS ? count : WHOLE_POINTS;
    bool *expected = malloc(n + m);
    assert_non_null(expected);
    for (int engine = 0; engine < 5; engine++)
        for (int whole = 0; whole < 2; whole++) {
            starg_visibility_options options;
            starg_bits *bits = NULL;
            starg_visibility_options_default(&options);
            options.engine = (starg_visibility_engine)engine;
            options.target = whole ? STARG_TARGET_FACES : STARG_TARGET_VERTICES;
            options.face_rule = STARG_FACES_WHOLE;
            test_ok(context, starg_visibility(context, solid, points, count, &options, &bits));
            for (size_t i = 0; i < (whole ? few : count); i++) {
                if (whole)
                    visibility_oracle_faces(v, n, f, m, points + 3 * i, true, expected);
                else
                    visibility_oracle_vertices(v, n, f, m, points + 3 * i, expected);
                compare(name, engines[engine], bits, i, expected);
            }
            starg_bits_free(bits);
        }
    free(expected);
}

/* Consumes the shape. */
static void check_shape(const char *name, shape s, uint64_t seed) {
    starg_context *context = test_context(2);
    starg_solid *solid = NULL;
    starg_mesh *mesh = test_mesh_of(context, &s);
    test_ok(context, starg_solid_create(context, mesh, &solid));
    check_solid(context, name, solid, seed);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
    shape_free(&s);
}

static void test_lattice(void **state) {
    (void)state;
    check_shape("tetrahedron", shape_tetrahedron(), 1);
    check_shape("cube", shape_cube(3), 2);
    check_shape("room", shape_room(), 3);
    check_shape("columns", shape_columns(), 4);
    shape far = shape_columns();
    shape_place(&far, 0.1, 1e6);
    check_shape("columns far away", far, 5);
}

/* Random cells: tunnels, cavities, pillars. Only those with a manifold surface are solids. */
static void test_random_cells(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    size_t solids = 0;
    for (uint64_t i = 0; i < 200 && solids < 4; i++) {
        char cells[4 * 4 * 3 + 1] = "";
        starg_rng rng = starg_rng_make(17, i, 0);
        for (size_t k = 0; k < sizeof cells - 1; k++)
            cells[k] = starg_rng_below(&rng, 8) < 7 ? '#' : '.';
        shape s = shape_cells(cells, 4, 4, 3);
        starg_solid *solid = NULL;
        starg_mesh *mesh = test_mesh_of(context, &s);
        if (starg_solid_create(context, mesh, &solid) == STARG_OK) {
            check_solid(context, "random cells", solid, i);
            solids++;
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    assert_int_equal(solids, 4);
    test_context_free(context);
}

/* Cavities with solids in them. */
static void test_nested_shells(void **state) {
    (void)state;
    static const double centre[3] = {0, 0, 0};
    check_shape("cavity", shape_cavity(), 6);
    shape s = shape_blob(2, 1);
    static const double scales[] = {0.5, 0.25, 0.1};
    for (int i = 0; i < 3; i++) {
        shape inner = shape_blob(1, (uint64_t)i + 2);
        shape_place(&inner, scales[i], 0);
        shape_append(&s, &inner, centre, i % 2 == 0);
        shape_free(&inner);
    }
    check_shape("nested blobs", s, 7);
}

/* Shells that cross or touch. */
static void test_not_embedded(void **state) {
    (void)state;
    static const double offsets[][3] = {{1, 1, 1}, {0.5, 0.25, 0}, {2, 0, 0}, {1, 2, 0.5}};
    for (size_t i = 0; i < sizeof offsets / sizeof *offsets; i++) {
        shape s = shape_cube(2), other = shape_cube(2);
        shape_append(&s, &other, offsets[i], 0);
        shape_free(&other);
        check_shape("two cubes", s, 20 + i);
    }
}

/* Flattened until faces are slivers and nearly coplanar, by a linear map and by noise. */
static void test_slivers(void **state) {
    (void)state;
    static const double flat[] = {1e-3, 1e-9, 1e-15};
    for (size_t i = 0; i < 3; i++) {
        shape s = shape_blob(2, 40 + i);
        for (size_t v = 0; v < s.vertex_count; v++)
            s.vertices[3 * v + 2] *= flat[i];
        check_shape("flat blob", s, 30 + i);
        s = shape_columns();
        for (size_t k = 0; k < 3 * s.vertex_count; k++) {
            starg_rng rng = starg_rng_make(50, i, k);
            s.vertices[k] += flat[i] * (starg_rng_unit(&rng) - 0.5);
        }
        check_shape("shaken columns", s, 40 + i);
    }
}

/* Blobs see much of themselves from anywhere, tubes little: contours of all kinds. */
static void test_blobs(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 4; i++)
        check_shape("blob", shape_blob(2, 60 + i), 60 + i);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lattice),       cmocka_unit_test(test_random_cells),
        cmocka_unit_test(test_nested_shells), cmocka_unit_test(test_not_embedded),
        cmocka_unit_test(test_slivers),       cmocka_unit_test(test_blobs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
