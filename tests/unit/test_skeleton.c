/* SPDX-License-Identifier: Apache-2.0 */
/* Curve skeletons of small shapes with known skeletons, their files, and bad options. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "models.h"
#include "starguard/sample.h"
#include "starguard/skeleton.h"

/* Everything that the header guarantees for any skeleton, from its arrays alone. */
static void check_promises(const starg_solid *solid, const starg_skeleton *s) {
    size_t parts = s->node_count, joints = 0, ends = 0;
    uint32_t *set = malloc(s->node_count * sizeof *set);
    size_t *degree = calloc(s->node_count, sizeof *degree);
    assert_non_null(set);
    assert_non_null(degree);
    for (uint32_t v = 0; v < s->node_count; v++) {
        const double *p = s->positions + 3 * (size_t)v;
        set[v] = v;
        assert_true(starg_solid_contains(solid, p));
        assert_true(s->radii[v] == starg_solid_distance(solid, p));
    }
    for (size_t e = 0; e < s->edge_count; e++) {
        uint32_t a = s->edges[2 * e], b = s->edges[2 * e + 1];
        assert_true(a < s->node_count && b < s->node_count && a != b);
        degree[a]++;
        degree[b]++;
        for (size_t other = 0; other < e && s->node_count < 500; other++) {
            const uint32_t *o = s->edges + 2 * other;
            assert_false((o[0] == a && o[1] == b) || (o[0] == b && o[1] == a));
        }
        if (set[a] == set[b])
            continue;
        uint32_t from = set[a], to = set[b];
        parts--;
        for (size_t v = 0; v < s->node_count; v++)
            set[v] = set[v] == from ? to : set[v];
    }
    for (size_t v = 0; v < s->node_count; v++) {
        joints += degree[v] > 2;
        ends += degree[v] == 1;
    }
    assert_int_equal(s->components, parts);
    assert_int_equal(s->loops, s->edge_count + parts - s->node_count);
    assert_int_equal(s->joints, joints);
    assert_int_equal(s->ends, ends);
    assert_int_equal(s->vertex_count, starg_mesh_vertex_count(starg_solid_mesh(solid)));
    for (size_t v = 0; v < s->vertex_count; v++)
        assert_true(s->vertex_nodes[v] < s->node_count);
    free(set);
    free(degree);
}

static void expect(const shape *s, size_t components, size_t loops, bool homotopic) {
    starg_context *context = test_context(2);
    starg_solid *solid = test_solid_of(context, s);
    starg_skeleton *skeleton = NULL;
    const starg_skeleton_options options = {.node_count = 100, .prune = 1.5};
    test_ok(context, starg_skeleton_create(context, solid, &options, &skeleton));
    check_promises(solid, skeleton);
    assert_int_equal(skeleton->components, components);
    assert_int_equal(skeleton->loops, loops);
    assert_int_equal(skeleton->homotopic, homotopic);
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    test_context_free(context);
}

static void test_trees(void **state) {
    (void)state;
    shape shapes[] = {shape_tetrahedron(), shape_cube(1), shape_cube(4), shape_room(),
                      shape_blob(3, 5)};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        expect(&shapes[i], 1, 0, true);
        shape_free(&shapes[i]);
    }
}

static void test_loops(void **state) {
    (void)state;
    shape ring = shape_cells("####.####", 3, 3, 1);
    expect(&ring, 1, 1, true);
    shape_free(&ring);
    shape grate = shape_cells("######.#.######", 5, 3, 1);
    expect(&grate, 1, 2, true);
    shape_free(&grate);
}

static void test_components(void **state) {
    (void)state;
    shape both = shape_cells("####.####", 3, 3, 1);
    shape cube = shape_cube(2);
    const double offset[3] = {10, 1, -3};
    shape_append(&both, &cube, offset, 0);
    expect(&both, 2, 1, true);
    shape_free(&cube);
    shape_free(&both);
}

/* A wall around a cavity must be cut, and that is reported. */
static void test_cavity(void **state) {
    (void)state;
    shape hollow = shape_cavity();
    expect(&hollow, 1, 0, false);
    shape_free(&hollow);
}

static void test_scales(void **state) {
    (void)state;
    const double scales[] = {1e-9, 1e9, 1e60};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        shape ring = shape_cells("####.####", 3, 3, 1);
        shape_place(&ring, scales[i], 0);
        expect(&ring, 1, 1, true);
        shape_free(&ring);
    }
}

static void test_thin_plate(void **state) {
    (void)state;
    shape plate = shape_cube(3);
    for (size_t v = 0; v < plate.vertex_count; v++)
        plate.vertices[3 * v + 2] *= 1e-9;
    expect(&plate, 1, 0, true);
    shape_free(&plate);
}

/* All balls of a round solid are around its centre: the skeleton is a point. */
static void test_ball_is_a_point(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape ball = shape_blob(3, 5);
    for (size_t v = 0; v < ball.vertex_count; v++) {
        double *p = ball.vertices + 3 * v, r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int k = 0; k < 3; k++)
            p[k] /= r;
    }
    starg_solid *solid = test_solid_of(context, &ball);
    starg_skeleton *skeleton = NULL;
    test_ok(context, starg_skeleton_create(context, solid, NULL, &skeleton));
    check_promises(solid, skeleton);
    assert_int_equal(skeleton->node_count, 1);
    assert_int_equal(skeleton->edge_count, 0);
    assert_true(skeleton->radii[0] > 0.9);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(skeleton->positions[k]) < 0.1);
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    shape_free(&ball);
    test_context_free(context);
}

static starg_skeleton *bar(starg_context *context, starg_solid **solid, size_t nodes) {
    shape cells = shape_cells("############", 12, 1, 1);
    starg_skeleton *skeleton = NULL;
    const starg_skeleton_options options = {.node_count = nodes, .prune = 2.5};
    *solid = test_solid_of(context, &cells);
    test_ok(context, starg_skeleton_create(context, *solid, &options, &skeleton));
    check_promises(*solid, skeleton);
    shape_free(&cells);
    return skeleton;
}

/* A bar's skeleton is its axis: in its middle the balls touch four walls, half a cell away. */
static void test_bar(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = NULL;
    starg_skeleton *skeleton = bar(context, &solid, 200);
    size_t middle = 0;
    for (size_t v = 0; v < skeleton->node_count; v++) {
        const double *p = skeleton->positions + 3 * v;
        if (p[0] < 2 || p[0] > 10)
            continue;
        middle++;
        assert_true(skeleton->radii[v] > 0.35);
    }
    assert_true(middle > 50);
    for (size_t v = 0; v < skeleton->vertex_count; v++) {
        const double *p = starg_mesh_vertices(starg_solid_mesh(solid)) + 3 * v;
        const double *q = skeleton->positions + 3 * (size_t)skeleton->vertex_nodes[v];
        assert_true(fabs(p[0] - q[0]) < 1.5);
    }
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    test_context_free(context);
}

static void test_threads(void **state) {
    (void)state;
    starg_context *contexts[2] = {test_context(1), test_context(4)};
    starg_skeleton *skeletons[2];
    starg_solid *solids[2];
    for (int i = 0; i < 2; i++)
        skeletons[i] = bar(contexts[i], &solids[i], 300);
    assert_int_equal(skeletons[0]->node_count, skeletons[1]->node_count);
    assert_int_equal(skeletons[0]->edge_count, skeletons[1]->edge_count);
    assert_memory_equal(skeletons[0]->positions, skeletons[1]->positions,
                        3 * sizeof(double) * skeletons[0]->node_count);
    assert_memory_equal(skeletons[0]->edges, skeletons[1]->edges,
                        2 * sizeof(uint32_t) * skeletons[0]->edge_count);
    assert_memory_equal(skeletons[0]->vertex_nodes, skeletons[1]->vertex_nodes,
                        sizeof(uint32_t) * skeletons[0]->vertex_count);
    for (int i = 0; i < 2; i++) {
        starg_skeleton_free(contexts[i], skeletons[i]);
        starg_solid_free(solids[i]);
        test_context_free(contexts[i]);
    }
}

/* Counts the lines that start with a word, and returns the first line. */
static size_t count_lines(const char *path, const char *word, char first[128]) {
    FILE *file = fopen(path, "r");
    char line[512];
    size_t count = 0;
    assert_non_null(file);
    first[0] = '\0';
    while (fgets(line, sizeof line, file) != NULL) {
        if (first[0] == '\0')
            snprintf(first, 128, "%.127s", line);
        count += strncmp(line, word, strlen(word)) == 0;
    }
    fclose(file);
    return count;
}

static void test_files(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_solid *solid = NULL;
    starg_skeleton *skeleton = bar(context, &solid, 50);
    char folder[] = "/tmp/starg-skeleton-XXXXXX", path[64], first[128], wanted[128];
    assert_non_null(mkdtemp(folder));

    snprintf(path, sizeof path, "%s/a.obj", folder);
    test_ok(context, starg_skeleton_write(context, skeleton, path, STARG_SKELETON_AUTO));
    assert_int_equal(count_lines(path, "v ", first), skeleton->node_count);
    assert_int_equal(count_lines(path, "l ", first), skeleton->edge_count);
    unlink(path);

    snprintf(path, sizeof path, "%s/a.cg", folder);
    test_ok(context, starg_skeleton_write(context, skeleton, path, STARG_SKELETON_AUTO));
    assert_int_equal(count_lines(path, "v ", first), skeleton->node_count);
    assert_int_equal(count_lines(path, "e ", first), skeleton->edge_count);
    snprintf(wanted, sizeof wanted, "# D:3 NV:%zu NE:%zu\n", skeleton->node_count,
             skeleton->edge_count);
    assert_string_equal(first, wanted);
    unlink(path);

    snprintf(path, sizeof path, "%s/a.vtk", folder);
    test_ok(context, starg_skeleton_write(context, skeleton, path, STARG_SKELETON_AUTO));
    assert_int_equal(count_lines(path, "2 ", first), skeleton->edge_count);
    assert_int_equal(count_lines(path, "SCALARS radius", first), 1);
    unlink(path);

    snprintf(path, sizeof path, "%s/a.xyz", folder);
    assert_int_equal(starg_skeleton_write(context, skeleton, path, STARG_SKELETON_AUTO),
                     STARG_ERROR_ARGUMENT);
    assert_int_not_equal(access(path, F_OK), 0);
    rmdir(folder);
    starg_skeleton_free(context, skeleton);
    starg_solid_free(solid);
    test_context_free(context);
}

static void test_bad_options(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape cube = shape_cube(1);
    starg_solid *solid = test_solid_of(context, &cube);
    const starg_skeleton_options bad[] = {{.node_count = 0, .prune = 2},
                                          {.node_count = 100000000, .prune = 2},
                                          {.node_count = 10, .prune = 0.5},
                                          {.node_count = 10, .prune = NAN}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        starg_skeleton *skeleton = (starg_skeleton *)&cube;
        assert_int_equal(starg_skeleton_create(context, solid, &bad[i], &skeleton),
                         STARG_ERROR_ARGUMENT);
        assert_null(skeleton);
    }
    starg_solid_free(solid);
    shape_free(&cube);
    test_context_free(context);
}

/* One end per limb by default: spikes; arms, legs and head; legs, head and tail. */
static void test_limbs(void **state) {
    (void)state;
    static const struct {
        const char *name;
        size_t ends;
    } known[] = {{"star", 20}, {"human", 5}, {"horse", 6}, {"octopus", 9}, {"sphere", 0}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        starg_context *context = test_context(2);
        starg_mesh *mesh = NULL;
        starg_solid *solid = NULL;
        starg_skeleton *skeleton = NULL;
        test_ok(context, starg_sample_create(context, known[i].name, NULL, &mesh));
        test_ok(context, starg_solid_create(context, mesh, &solid));
        test_ok(context, starg_skeleton_create(context, solid, NULL, &skeleton));
        check_promises(solid, skeleton);
        if (skeleton->ends != known[i].ends)
            fail_msg("%s: %zu ends, not %zu", known[i].name, skeleton->ends, known[i].ends);
        starg_skeleton_free(context, skeleton);
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        test_context_free(context);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trees),      cmocka_unit_test(test_loops),
        cmocka_unit_test(test_components), cmocka_unit_test(test_cavity),
        cmocka_unit_test(test_limbs),      cmocka_unit_test(test_scales),
        cmocka_unit_test(test_thin_plate), cmocka_unit_test(test_ball_is_a_point),
        cmocka_unit_test(test_bar),        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_files),      cmocka_unit_test(test_bad_options)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
