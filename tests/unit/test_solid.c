/* SPDX-License-Identifier: Apache-2.0 */
/* The solid: rejections with their messages, shell orientation, order, containment and distance. */

#include "starguard/solid.h"
#include "starguard/space.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "models.h"
#include "support.h"

/* ---- helpers ---- */

typedef struct messages {
    int notices, warnings;
    char last[512];
} messages;

static void keep_message(void *user, starg_log_level level, const char *message) {
    messages *m = user;
    *(level == STARG_LOG_NOTICE ? &m->notices : &m->warnings) += 1;
    snprintf(m->last, sizeof m->last, "%s", message);
}

static starg_context *listening_context(messages *m) {
    starg_context_options options;
    starg_context_options_default(&options);
    options.log = keep_message;
    options.log_user = m;
    starg_context *context = NULL;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    return context;
}

static void expect_refusal(shape *s, const char *phrase, starg_element element, size_t indices,
                           uint64_t first) {
    starg_context *context = test_context(1);
    starg_solid *solid;
    starg_mesh *mesh = test_mesh_of(context, s);
    assert_int_equal(starg_solid_create(context, mesh, &solid), STARG_ERROR_MESH);
    assert_null(solid);
    const starg_error *error = starg_context_error(context);
    if (strstr(error->message, phrase) == NULL)
        fail_msg("'%s' is not in '%s'", phrase, error->message);
    assert_int_equal(error->element, element);
    assert_int_equal(error->index_count, indices);
    if (indices > 0)
        assert_int_equal(error->indices[0], first);
    starg_mesh_free(mesh);
    test_context_free(context);
    shape_free(s);
}

/* ---- refusals ---- */

static void test_refuses_open(void **state) {
    (void)state;
    shape s = shape_tetrahedron();
    s.face_count = 3;
    expect_refusal(&s, "open edges: 3", STARG_ELEMENT_EDGE, 6, 1);
}

static void test_refuses_inconsistent(void **state) {
    (void)state;
    shape s = shape_tetrahedron();
    s.faces[10] = 3;
    s.faces[11] = 2;
    expect_refusal(&s, "inconsistent edges: 3", STARG_ELEMENT_EDGE, 6, 1);
}

/* A wall without thickness in a room: its edges have three faces. */
static void test_refuses_nonmanifold(void **state) {
    (void)state;
    shape s = shape_tetrahedron();
    s.faces = realloc(s.faces, sizeof(uint32_t[18]));
    assert_non_null(s.faces);
    memcpy(s.faces + 12, s.faces, sizeof(uint32_t[3]));
    memcpy(s.faces + 15, s.faces + 3, sizeof(uint32_t[3]));
    s.face_count = 6;
    expect_refusal(&s, "non-manifold edges: 5", STARG_ELEMENT_EDGE, STARG_ERROR_INDICES, 0);
}

static void test_refuses_flat(void **state) {
    (void)state;
    shape s = shape_tetrahedron();
    for (size_t v = 0; v < s.vertex_count; v++)
        s.vertices[3 * v + 2] = 0;
    expect_refusal(&s, "encloses no volume", STARG_ELEMENT_NONE, 0, 0);
}

static void test_refuses_nothing(void **state) {
    (void)state;
    shape s = {0};
    expect_refusal(&s, "no faces", STARG_ELEMENT_NONE, 0, 0);
}

/* ---- accepted input ---- */

/* Two cells that touch along the edge over (1, 1) share its vertices: one gets copies of them, but
 * for the mesh that the solid shows. */
static void test_parts_cells(void **state) {
    (void)state;
    messages m = {0};
    shape s = shape_cells("#..#", 2, 2, 1);
    starg_context *context = listening_context(&m);
    starg_mesh *mesh = test_mesh_of(context, &s);
    starg_solid *solid = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    assert_true(m.notices == 1 && m.warnings == 0);
    assert_non_null(strstr(m.last, "share 2 vertices"));
    const starg_mesh *own = starg_solid_mesh(solid);
    assert_int_equal(starg_mesh_vertex_count(own), s.vertex_count);
    assert_int_equal(starg_solid_check(solid)->vertices, s.vertex_count + 2);
    assert_int_equal(starg_mesh_face_count(own), s.face_count);
    assert_int_equal(starg_space_model_vertices(solid), s.vertex_count);
    for (size_t i = 0; i < 3 * s.face_count; i++)
        assert_memory_equal(starg_mesh_vertices(own) + 3 * (size_t)starg_mesh_faces(own)[i],
                            s.vertices + 3 * (size_t)s.faces[i], sizeof(double[3]));
    assert_int_equal(starg_solid_check(solid)->components, 2);
    assert_true(fabs(starg_solid_check(solid)->volume - 2) < 1e-12);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
    shape_free(&s);
}

static void test_keeps_order(void **state) {
    (void)state;
    messages m = {0};
    starg_context *context = listening_context(&m);
    shape s = shape_columns();
    starg_solid *solid = test_solid_of(context, &s);
    const starg_mesh *mesh = starg_solid_mesh(solid);
    assert_int_equal(starg_mesh_face_count(mesh), s.face_count);
    assert_memory_equal(starg_mesh_faces(mesh), s.faces, 3 * s.face_count * sizeof(uint32_t));
    assert_memory_equal(starg_mesh_vertices(mesh), s.vertices, 3 * s.vertex_count * sizeof(double));
    assert_true(starg_solid_check(solid)->usable);
    assert_int_equal(m.notices + m.warnings, 0);
    starg_solid_free(solid);
    shape_free(&s);
    test_context_free(context);
}

static void test_turns_shells_with_a_notice(void **state) {
    (void)state;
    messages m = {0};
    starg_context *context = listening_context(&m);
    shape s = shape_cube(1), inner = shape_cube(1);
    shape_place(&s, 4, 0);
    shape_append(&s, &inner, (const double[3]){1, 1, 1}, 0); /* a cavity given outward */
    starg_solid *solid = test_solid_of(context, &s);
    assert_int_equal(m.notices, 1);
    assert_int_equal(m.warnings, 0);
    assert_non_null(strstr(m.last, "1 of 2 shells"));
    assert_true(fabs(starg_mesh_volume(starg_solid_mesh(solid)) - 63) < 1e-9);
    assert_int_equal(starg_solid_check(solid)->findings[STARG_FINDING_INWARD_COMPONENT].count, 1);
    assert_true(starg_solid_contains(solid, (const double[3]){0.5, 0.5, 0.5}));
    assert_false(starg_solid_contains(solid, (const double[3]){1.5, 1.5, 1.5}));
    assert_false(starg_solid_contains(solid, (const double[3]){1, 1.5, 1.5}));
    starg_solid_free(solid);
    shape_free(&s);
    shape_free(&inner);
    test_context_free(context);
}

static void test_warns_of_intersections(void **state) {
    (void)state;
    messages m = {0};
    starg_context *context = listening_context(&m);
    shape s = shape_cube(2), other = shape_cube(2);
    shape_append(&s, &other, (const double[3]){0.75, 0.5, 0.25}, 0);
    starg_solid *solid = test_solid_of(context, &s);
    assert_int_equal(m.notices, 0);
    assert_int_equal(m.warnings, 1);
    assert_non_null(strstr(m.last, "intersect"));
    /* in one, in both, in none */
    assert_true(starg_solid_contains(solid, (const double[3]){0.1, 0.1, 0.1}));
    assert_true(starg_solid_contains(solid, (const double[3]){1.1, 1.2, 1.3}));
    assert_false(starg_solid_contains(solid, (const double[3]){2.5, 0.1, 0.1}));
    starg_solid_free(solid);
    shape_free(&s);
    shape_free(&other);
    test_context_free(context);
}

/* ---- queries ---- */

static void test_contains_against_oracle(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape shapes[] = {shape_room(), shape_cavity(), shape_columns(), shape_blob(2, 3)};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        starg_solid *solid = test_solid_of(context, &shapes[i]);
        for (uint64_t round = 0; round < 100; round++) {
            starg_rng rng = starg_rng_make(9, i, round);
            double p[3];
            bool on_surface;
            for (int k = 0; k < 3; k++)
                p[k] = 0.5 * (double)starg_rng_below(&rng, 13) - 1;
            int winding = oracle_winding(shapes[i].vertices, shapes[i].faces, shapes[i].face_count,
                                         p, &on_surface);
            assert_int_equal(starg_solid_contains(solid, p), winding > 0 && !on_surface);
            double d = starg_solid_distance(solid, p);
            assert_true(on_surface ? d < 1e-12 : d > 0);
        }
        starg_solid_free(solid);
        shape_free(&shapes[i]);
    }
    test_context_free(context);
}

static void test_distance(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(1);
    starg_solid *solid = test_solid_of(context, &s);
    assert_true(fabs(starg_solid_distance(solid, (const double[3]){0.5, 0.5, 0.25}) - 0.25) <
                1e-15);
    assert_true(fabs(starg_solid_distance(solid, (const double[3]){2, 2, 2}) - sqrt(3)) < 1e-15);
    assert_true(starg_solid_distance(solid, (const double[3]){0.5, 1, 0.25}) == 0);
    starg_solid_free(solid);
    starg_solid_free(NULL);
    shape_free(&s);
    test_context_free(context);
}

/* Each face with its own vertices, as written along seams: the solid is that of the welded mesh,
 * and vertices and faces keep their numbers. */
static void test_welds_seams(void **state) {
    (void)state;
    for (int missing = 0; missing < 2; missing++) {
        messages heard = {0};
        starg_context *context = listening_context(&heard);
        shape s = shape_cube(1);
        starg_solid *solid = NULL;
        starg_mesh *mesh = NULL;
        size_t corners = 3 * (s.face_count - (size_t)missing);
        double *vertices = malloc(3 * corners * sizeof *vertices);
        uint32_t *faces = malloc(corners * sizeof *faces);
        assert_true(vertices != NULL && faces != NULL);
        for (size_t i = 0; i < corners; i++) {
            memcpy(vertices + 3 * i, s.vertices + 3 * (size_t)s.faces[i], 3 * sizeof *vertices);
            faces[i] = (uint32_t)i;
        }
        test_ok(context, starg_mesh_create(context, vertices, corners, faces, corners / 3, &mesh));
        starg_status status = starg_solid_create(context, mesh, &solid);
        assert_int_equal(status, missing ? STARG_ERROR_MESH : STARG_OK);
        assert_int_equal(heard.notices, !missing);
        for (size_t i = 0; !missing && i < corners; i++) {
            const starg_mesh *own = starg_solid_mesh(solid);
            uint32_t v = starg_mesh_faces(own)[i];
            assert_int_equal(starg_mesh_vertex_count(own), corners);
            assert_true(v <= i && s.faces[v] == s.faces[i]);
            for (uint32_t k = 0; k < v; k++) /* the first one */
                assert_int_not_equal(s.faces[k], s.faces[i]);
        }
        if (missing) /* the defects of the given mesh, not of the welded one */
            assert_non_null(strstr(starg_context_error(context)->message, "open edges: 33"));
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        free(vertices);
        free(faces);
        shape_free(&s);
        test_context_free(context);
    }
}

/* Solids whose areas and volumes would underflow are rejected; scaled up they are accepted. */
static void test_narrow(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    static const double scales[] = {1e-320, 1e-200, 1e-110, 9e-91, 1e-90, 1e-60};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        shape s = shape_cube(1);
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        for (size_t k = 0; k < 3 * s.vertex_count; k++)
            s.vertices[k] = s.vertices[k] > 0 ? scales[i] : 0;
        test_ok(context, starg_mesh_create(context, s.vertices, s.vertex_count, s.faces,
                                           s.face_count, &mesh));
        bool narrow = scales[i] < 1e-90;
        assert_int_equal(starg_solid_create(context, mesh, &solid),
                         narrow ? STARG_ERROR_RANGE : STARG_OK);
        if (narrow)
            assert_non_null(strstr(starg_context_error(context)->message, "power of two"));
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        shape_free(&s);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_welds_seams),
        cmocka_unit_test(test_narrow),
        cmocka_unit_test(test_refuses_open),
        cmocka_unit_test(test_refuses_inconsistent),
        cmocka_unit_test(test_refuses_nonmanifold),
        cmocka_unit_test(test_refuses_flat),
        cmocka_unit_test(test_refuses_nothing),
        cmocka_unit_test(test_parts_cells),
        cmocka_unit_test(test_keeps_order),
        cmocka_unit_test(test_turns_shells_with_a_notice),
        cmocka_unit_test(test_warns_of_intersections),
        cmocka_unit_test(test_contains_against_oracle),
        cmocka_unit_test(test_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
