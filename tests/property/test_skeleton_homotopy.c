/* SPDX-License-Identifier: Apache-2.0 */
/* Skeletons of real models: components and loops against the Euler characteristic of the model's
 * surface, both counted here by slow and simple means; nodes inside; the same counts after a rigid
 * motion. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/skeleton.h"

static const char *const MODELS[] = {
    "solids/3holes.off",         "solids/eight.off",
    "solids/elephant_g3.off",    "solids/femur_g2.off",
    "solids/bull.off",           "solids/hand_1197.off",
    "table2/kitten_400.off",     "table2/kitten_10k.off",
    "table2/bimba_752.off",      "table2/bunny_998.off",
    "table2/beethoven_502.off",  "table2/buddha_502.off",
    "cad/bamboo_pen.off",        "cad/letter_p.off",
    "cad/three_torus.off",       "cad/spool.off",
    "cad/vase_374_g1.off",       "cad/star.off",
    "tosca_paper/wolf0.off",     "tosca_paper/david0.off",
    "solids/chinese_dragon.off", "retrieval_shrec07/airplane_076.off",
};

/* Joins the ends of all pairs until nothing changes; counts the components. */
static size_t count_parts(size_t count, const uint32_t *pairs, size_t pair_count) {
    uint32_t *lowest = malloc(count * sizeof *lowest);
    size_t parts = 0;
    bool changed = true;
    assert_non_null(lowest);
    for (uint32_t v = 0; v < count; v++)
        lowest[v] = v;
    while (changed) {
        changed = false;
        for (size_t i = 0; i < 2 * pair_count; i++)
            if (lowest[pairs[i]] > lowest[pairs[i ^ 1]]) {
                lowest[pairs[i]] = lowest[pairs[i ^ 1]];
                changed = true;
            }
    }
    for (uint32_t v = 0; v < count; v++)
        parts += lowest[v] == v;
    free(lowest);
    return parts;
}

/* Vertices - edges + faces = 2 (components - genus) on a closed surface without isolated
 * vertices. */
static size_t genus_of(const starg_mesh *mesh, size_t *parts) {
    size_t faces = starg_mesh_face_count(mesh), vertices = starg_mesh_vertex_count(mesh);
    uint32_t *pairs = malloc(6 * faces * sizeof *pairs);
    assert_non_null(pairs);
    for (size_t f = 0; f < faces; f++)
        for (size_t k = 0; k < 3; k++) {
            pairs[6 * f + 2 * k] = starg_mesh_faces(mesh)[3 * f + k];
            pairs[6 * f + 2 * k + 1] = starg_mesh_faces(mesh)[3 * f + (k + 1) % 3];
        }
    *parts = count_parts(vertices, pairs, 3 * faces);
    free(pairs);
    return (2 * *parts + 3 * faces / 2 - vertices - faces) / 2;
}

static starg_mesh *read_model(starg_context *context, const char *folder, const char *name) {
    char path[512];
    starg_mesh *mesh = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    test_ok(context, starg_mesh_read(context, path, &mesh));
    return mesh;
}

static void check_mesh(starg_context *context, const starg_mesh *mesh, const char *name) {
    starg_solid *solid = NULL;
    starg_skeleton *s = NULL;
    size_t parts, genus = genus_of(mesh, &parts);
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, starg_skeleton_create(context, solid, NULL, &s));
    size_t found = count_parts(s->node_count, s->edges, s->edge_count);
    if (found != parts || s->edge_count + found - s->node_count != genus)
        fail_msg("%s: %zu parts, %zu loops; the surface has %zu and %zu", name, found,
                 s->edge_count + found - s->node_count, parts, genus);
    assert_int_equal(s->components, parts);
    assert_int_equal(s->loops, genus);
    assert_int_equal(s->cuts, 0);
    assert_int_equal(s->mends, 0);
    assert_true(s->homotopic);
    for (size_t v = 0; v < s->node_count; v++) {
        assert_true(starg_solid_contains(solid, s->positions + 3 * v));
        assert_true(s->radii[v] == starg_solid_distance(solid, s->positions + 3 * v));
    }
    for (size_t v = 0; v < s->vertex_count; v++)
        assert_true(s->vertex_nodes[v] < s->node_count);
    starg_skeleton_free(context, s);
    starg_solid_free(solid);
}

static void test_shared_models(void **state) {
    (void)state;
    const char *folder = test_shared_data();
    if (folder == NULL)
        skip();
    for (size_t i = 0; i < sizeof MODELS / sizeof *MODELS; i++) {
        starg_context *context = test_context(0);
        starg_mesh *mesh = read_model(context, folder, MODELS[i]);
        check_mesh(context, mesh, MODELS[i]);
        starg_mesh_free(mesh);
        test_context_free(context);
    }
}

/* Boxes a hundredth apart, with faces a thousand times as long: samples cannot follow both sides.
 * Counts are repaired, and that is reported, since the wrong loop may have been cut. */
static void test_mended_model(void **state) {
    (void)state;
    const char *folder = test_shared_data();
    if (folder == NULL)
        skip();
    starg_context *context = test_context(0);
    starg_mesh *mesh = read_model(context, folder, "cad/mpi_triang.off");
    starg_solid *solid = NULL;
    starg_skeleton *s = NULL;
    test_ok(context, starg_solid_create(context, mesh, &solid));
    test_ok(context, starg_skeleton_create(context, solid, NULL, &s));
    assert_int_equal(s->components, 1);
    assert_int_equal(s->loops, 1);
    assert_true(s->mends > 0);
    assert_false(s->homotopic);
    starg_skeleton_free(context, s);
    starg_solid_free(solid);
    starg_mesh_free(mesh);
    test_context_free(context);
}

/* Rounding of coordinates changes every decision of the Delaunay tetrahedra, but no count. */
static void test_rigid_motion(void **state) {
    (void)state;
    const char *folder = test_shared_data();
    if (folder == NULL)
        skip();
    starg_context *context = test_context(0);
    starg_mesh *mesh = read_model(context, folder, "solids/eight.off");
    for (int turn = 1; turn < 6; turn++) {
        size_t count = starg_mesh_vertex_count(mesh);
        double *p = malloc(3 * count * sizeof *p), c = cos(turn), s = sin(turn);
        starg_mesh *moved = NULL;
        assert_non_null(p);
        for (size_t v = 0; v < count; v++) {
            const double *q = starg_mesh_vertices(mesh) + 3 * v;
            p[3 * v] = c * q[0] - s * q[1] + 5 * turn;
            p[3 * v + 1] = c * (s * q[0] + c * q[1]) - s * q[2];
            p[3 * v + 2] = s * (s * q[0] + c * q[1]) + c * q[2] - turn;
        }
        test_ok(context, starg_mesh_create(context, p, count, starg_mesh_faces(mesh),
                                           starg_mesh_face_count(mesh), &moved));
        check_mesh(context, moved, "eight.off, moved");
        starg_mesh_free(moved);
        free(p);
    }
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shared_models),
                                       cmocka_unit_test(test_mended_model),
                                       cmocka_unit_test(test_rigid_motion)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
