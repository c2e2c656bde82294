/* SPDX-License-Identifier: Apache-2.0 */
/* Real solids: every engine and the verifier agree bit for bit with the definition: every segment
 * against every triangle, in rationals where doubles are not certain. With STARGUARD_LONG all
 * solids of the shared data of up to 5,000 vertices, otherwise the smallest of them. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/visibility.h"
#include "verify/sight.h"
#include "visibility_oracle.h"

enum { ENGINES = 5, MOST_POINTS = 4 };

/* Points inside, cyclically: a candidate guard; on the line through two corners of a face; the
 * midpoint of two vertices; a candidate moved into the axis-parallel plane of a vertex. */
static size_t pick_points(starg_context *context, const starg_solid *solid, size_t wanted,
                          double *points) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    size_t count = 0, candidates = 0;
    double *places = NULL;
    test_ok(context, starg_candidate_points(context, solid, STARG_CANDIDATES_INTERIOR, 100, 0,
                                            &places, &candidates));
    for (uint64_t attempt = 0; candidates > 0 && attempt < 500 && count < wanted; attempt++) {
        starg_rng rng = starg_rng_make(23, count, attempt);
        const double *place = places + 3 * starg_rng_below(&rng, candidates);
        const uint32_t *face = f + 3 * starg_rng_below(&rng, starg_mesh_face_count(mesh));
        const double *a = v + 3 * (size_t)face[0], *b = v + 3 * (size_t)face[1];
        const double *c = v + 3 * starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        size_t axis = starg_rng_below(&rng, 3);
        double along = 4 * starg_rng_unit(&rng) - 1.5, p[3];
        for (size_t k = 0; k < 3; k++) {
            const double kinds[4] = {place[k], a[k] + along * (b[k] - a[k]), (a[k] + c[k]) / 2,
                                     k == axis ? a[k] : place[k]};
            p[k] = kinds[count % 4];
        }
        if (starg_solid_contains(solid, p))
            memcpy(points + 3 * count++, p, sizeof p);
    }
    starg_points_free(context, places);
    return count;
}

/* What is visible by the definition. */
typedef struct sight {
    bool *vertices, *faces;
} sight;

static void compare_engine(starg_context *context, const char *name, const starg_solid *solid,
                           const double p[3], starg_visibility_options options,
                           const bool *expected) {
    static const char *const engines[ENGINES] = {"grid", "bvh", "sweep", "contours", "fastest"};
    starg_bits *bits = NULL;
    test_ok(context, starg_visibility(context, solid, p, 1, &options, &bits));
    for (size_t i = 0; i < starg_bits_columns(bits); i++)
        if (starg_bits_test(bits, 0, i) != expected[i])
            fail_msg("%s, %s, rule %d, from (%a, %a, %a): column %zu is %d by definition", name,
                     engines[options.engine], (int)options.face_rule, p[0], p[1], p[2], i,
                     expected[i]);
    starg_bits_free(bits);
}

static void compare_verifier(const char *name, const starg_mesh *mesh, verify_sight *own,
                             const double p[3], starg_face_rule rule, const sight *expected) {
    const verify_view view = {.range = INFINITY, .rule = rule};
    const uint8_t *vertices, *faces;
    const uint32_t *f = starg_mesh_faces(mesh);
    assert_int_equal(verify_look(own, p, &view, &vertices, &faces), STARG_OK);
    for (size_t i = 0; i < 3 * starg_mesh_face_count(mesh); i++)
        if (vertices[f[i]] != expected->vertices[f[i]] || faces[i / 3] != expected->faces[i / 3])
            fail_msg("%s, verifier, rule %d, from (%a, %a, %a): face %zu", name, (int)rule, p[0],
                     p[1], p[2], i / 3);
}

static void check_point(starg_context *context, const char *name, const starg_solid *solid,
                        verify_sight *own, const double p[3], const sight *expected) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    const double *v = starg_mesh_vertices(mesh);
    const uint32_t *f = starg_mesh_faces(mesh);
    size_t n = starg_mesh_vertex_count(mesh), m = starg_mesh_face_count(mesh);
    visibility_oracle_vertices(v, n, f, m, p, expected->vertices);
    for (int rule = 0; rule < 2; rule++) {
        visibility_oracle_faces_from(v, f, m, p, rule == STARG_FACES_WHOLE, expected->vertices,
                                     expected->faces);
        for (int engine = 0; engine < ENGINES; engine++) {
            starg_visibility_options options;
            starg_visibility_options_default(&options);
            options.engine = (starg_visibility_engine)engine;
            options.face_rule = (starg_face_rule)rule;
            compare_engine(context, name, solid, p, options, expected->faces);
            options.target = STARG_TARGET_VERTICES;
            if (rule == 0)
                compare_engine(context, name, solid, p, options, expected->vertices);
        }
        compare_verifier(name, mesh, own, p, (starg_face_rule)rule, expected);
    }
}

static size_t check_solid(starg_context *context, const char *name, const starg_solid *solid,
                          size_t wanted) {
    const starg_mesh *mesh = starg_solid_mesh(solid);
    verify_surface *surface = NULL;
    verify_sight *own = NULL;
    double points[3 * MOST_POINTS];
    size_t count = pick_points(context, solid, wanted, points);
    const sight expected = {malloc(starg_mesh_vertex_count(mesh)),
                            malloc(starg_mesh_face_count(mesh))};
    assert_true(expected.vertices != NULL && expected.faces != NULL);
    test_ok(context, verify_surface_create(context, mesh, &surface));
    test_ok(context, verify_sight_create(surface, &own));
    for (size_t i = 0; i < count; i++)
        check_point(context, name, solid, own, points + 3 * i, &expected);
    verify_sight_free(own);
    verify_surface_free(surface);
    free(expected.vertices);
    free(expected.faces);
    return count;
}

static void test_shared_solids(void **state) {
    (void)state;
    const char *data = test_shared_data();
    if (data == NULL)
        skip();
    size_t most = test_rounds(350, 5000), wanted = test_rounds(2, MOST_POINTS);
    size_t solids = 0, points = 0;
    FILE *tables = test_tables(data);
    starg_context *context = test_context(1);
    for (test_row row = {0}; test_next_row(tables, data, &row);) {
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        if (starg_mesh_read(context, row.path, &mesh) == STARG_OK &&
            starg_mesh_vertex_count(mesh) <= most &&
            starg_solid_create(context, mesh, &solid) == STARG_OK) {
            points += check_solid(context, row.file, solid, wanted);
            solids++;
        }
        starg_solid_free(solid);
        starg_mesh_free(mesh);
    }
    fclose(tables);
    printf("%zu solids of up to %zu vertices, %zu points\n", solids, most, points);
    assert_true(solids > 10 && points > 15);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shared_solids)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
