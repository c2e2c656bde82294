/* SPDX-License-Identifier: Apache-2.0 */
/* Skeleton files: round trips through each format, hand-written files, and rejected files with the
 * line of the error. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/skeleton.h"

static starg_status read_text(starg_context *context, const char *text, starg_skeleton **out) {
    return starg_skeleton_read_memory(context, text, strlen(text), "curve.txt", out);
}

static void round_trips(void **state) {
    (void)state;
    static const char *const extensions[] = {"obj", "cg", "vtk"};
    static const char *const models[] = {"octopus", "torus", "plate", "sphere"};
    starg_context *context = test_context(1);
    for (size_t m = 0; m < 4; m++) {
        starg_solid *solid = test_sample(context, models[m], 800);
        starg_skeleton *made = NULL;
        test_ok(context, starg_skeleton_create(context, solid, NULL, &made));
        for (size_t i = 0; i < 3; i++) {
            char path[64];
            starg_skeleton *read = NULL;
            snprintf(path, sizeof path, "/tmp/test_skeleton_%ld.%s", (long)getpid(), extensions[i]);
            test_ok(context, starg_skeleton_write(context, made, path, STARG_SKELETON_AUTO));
            test_ok(context, starg_skeleton_read(context, path, &read));
            unlink(path);
            assert_int_equal(read->node_count, made->node_count);
            assert_int_equal(read->edge_count, made->edge_count);
            assert_memory_equal(read->positions, made->positions,
                                3 * made->node_count * sizeof *made->positions);
            for (size_t e = 0; e < 2 * made->edge_count; e++)
                assert_int_equal(read->edges[e], made->edges[e]);
            assert_int_equal(read->radii != NULL, i == 2);
            if (read->radii != NULL)
                assert_memory_equal(read->radii, made->radii,
                                    made->node_count * sizeof *made->radii);
            assert_int_equal(read->components, made->components);
            assert_int_equal(read->loops, made->loops);
            assert_int_equal(read->joints, made->joints);
            assert_int_equal(read->ends, made->ends);
            starg_skeleton_free(context, read);
        }
        starg_skeleton_free(context, made);
        starg_solid_free(solid);
    }
    test_context_free(context);
}

/* A polyline of OBJ becomes an edge per step. */
static void polylines(void **state) {
    (void)state;
    static const char text[] = "# by hand\nv 0 0 0\nv 1 0 0 \nv 1 1 0\nv 5 5 5\nl 1 2 3 1\n";
    static const uint32_t edges[] = {0, 1, 1, 2, 2, 0};
    starg_context *context = test_context(1);
    starg_skeleton *s = NULL;
    test_ok(context, read_text(context, text, &s));
    assert_int_equal(s->edge_count, 3);
    assert_memory_equal(s->edges, edges, sizeof edges);
    assert_int_equal(s->components, 2);
    assert_int_equal(s->loops, 1);
    assert_int_equal(s->ends, 0);
    starg_skeleton_free(context, s);
    test_context_free(context);
}

static void expect_same_trees(const starg_skeleton *read, const starg_skeleton *made) {
    double sums[2] = {0, 0}, radii[2] = {0, 0};
    const starg_skeleton *both[] = {read, made};
    for (int i = 0; i < 2; i++) {
        const starg_skeleton *s = both[i];
        for (size_t e = 0; e < s->edge_count; e++) {
            const double *a = s->positions + 3 * (size_t)s->edges[2 * e];
            const double *b = s->positions + 3 * (size_t)s->edges[2 * e + 1];
            sums[i] += fabs(a[0] - b[0]) + 3 * fabs(a[1] - b[1]) + 7 * fabs(a[2] - b[2]);
        }
        for (size_t v = 0; v < s->node_count; v++)
            radii[i] += s->radii[v] * (1 + s->positions[3 * v] * s->positions[3 * v]);
    }
    assert_true(fabs(sums[0] - sums[1]) <= 1e-9 * sums[1]);
    assert_true(fabs(radii[0] - radii[1]) <= 1e-9 * radii[1]);
    assert_int_equal(read->node_count, made->node_count);
    assert_int_equal(read->edge_count, made->edge_count);
    assert_int_equal(read->components, made->components);
    assert_int_equal(read->joints, made->joints);
    assert_int_equal(read->ends, made->ends);
}

/* SWC has an order of its own: each node after its parent. A loop is refused. */
static void trees(void **state) {
    (void)state;
    char path[64];
    snprintf(path, sizeof path, "/tmp/test_skeleton_%ld.swc", (long)getpid());
    starg_context *context = test_context(1);
    starg_solid *solid = test_sample(context, "octopus", 800);
    starg_skeleton *made = NULL, *read = NULL;
    test_ok(context, starg_skeleton_create(context, solid, NULL, &made));
    test_ok(context, starg_skeleton_write(context, made, path, STARG_SKELETON_AUTO));
    test_ok(context, starg_skeleton_read(context, path, &read));
    expect_same_trees(read, made);
    for (size_t e = 0; e < read->edge_count; e++)
        assert_true(read->edges[2 * e] < read->edges[2 * e + 1]);
    unlink(path);
    starg_skeleton_free(context, read);
    starg_skeleton_free(context, made);
    starg_solid_free(solid);

    solid = test_sample(context, "torus", 800);
    test_ok(context, starg_skeleton_create(context, solid, NULL, &made));
    assert_int_equal(starg_skeleton_write(context, made, path, STARG_SKELETON_AUTO),
                     STARG_ERROR_MESH);
    assert_non_null(strstr(starg_context_error(context)->message, "1 loop, and SWC"));
    assert_int_equal(access(path, F_OK), -1);
    starg_skeleton_free(context, made);
    starg_solid_free(solid);

    /* gaps between ids, a parent after its child, comments */
    test_ok(context, read_text(context,
                               "# by hand\n\n7 3 1 0 0 .5 90 # tip\n90 1 0 0 0 1 -1\n"
                               "8 0 0 1 0 .25 90\n",
                               &read));
    assert_int_equal(read->node_count, 3);
    assert_int_equal(read->edge_count, 2);
    assert_int_equal(read->ends, 2);
    assert_true(read->radii[0] == .5 && read->radii[1] == 1 && read->radii[2] == .25);
    starg_skeleton_free(context, read);
    test_context_free(context);
}

#define VTK_HEAD "# vtk DataFile Version 3.0\ncurve\nASCII\nDATASET POLYDATA\n"

static void refusals(void **state) {
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"", "no nodes"},
        {"# D:3 NV:0 NE:0\n", "no nodes"},
        {"v 0 0 0\nv 1 1 1\nl 1 3\n", "missing node"},
        {"v 0 0 0\nv 1 1 1\nl 0 1\n", "line 3"},
        {"v 0 0 0\nv 1 1 1\nl -1 -2\n", "line 3"},
        {"v 0 0 0\nv 1 1 1\nl 1\n", "two nodes"},
        {"v 0 0 0\nv 1 1 1\nl 1 99999999999999999999\n", "line 3"},
        {"v 0 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3\n", "surface"},
        {"v 0 0 1e200\n", "line 1"},
        {"v 0 0 nan\n", "line 1"},
        {"v 0 0 x\n", "line 1"},
        {VTK_HEAD "POINTS 1 double\n0 0\n", "coordinate"},
        {VTK_HEAD "POINTS 900000000 double\n0 0 0\n", "larger than the file"},
        {VTK_HEAD "POINTS 1 double\n0 0 0\nLINES 1 3\n2 0 1\n", "missing node"},
        {VTK_HEAD "POINTS 1 double\n0 0 0\nLINES 1 3\n2 0 -1\n", "impossible"},
        {VTK_HEAD "POINTS 1 double\n0 0 0\nPOLYGONS 1 3\n", "not part"},
        {VTK_HEAD "POINTS 1 double\n0 0 0\nPOINT_DATA 1\nSCALARS radius double 1\n"
                  "LOOKUP_TABLE default\n-1\n",
         "negative"},
        {"1 0 0 0 0 1 -1\n1 0 1 0 0 1 -1\n", "two nodes have one id"},
        {"1 0 0 0 0 1 -1\n2 0 1 0 0 1 3\n", "parent of a node is missing"},
        {"1 0 0 0 0 1 1\n", "parent of a node is missing"},
        {"1 0 0 0 0 -1 -1\n", "negative"},
        {"1 0 0 0 0 1\n", "parent"},
        {"# vtk DataFile Version 3.0\ncurve\nBINARY\nDATASET POLYDATA\n", "ASCII"},
    };
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        starg_skeleton *s = NULL;
        assert_int_equal(read_text(context, cases[i].text, &s), STARG_ERROR_FORMAT);
        assert_null(s);
        if (strstr(starg_context_error(context)->message, cases[i].says) == NULL)
            fail_msg("case %zu: %s", i, starg_context_error(context)->message);
    }
    starg_skeleton *s = NULL;
    assert_int_equal(starg_skeleton_read(context, "/nowhere/curve.obj", &s), STARG_ERROR_READ);
    test_context_free(context);
}

static const char GOOD[] =
    VTK_HEAD "POINTS 4 double\n0 0 0\n1 0 0\n2 0 0\n1 1 0\nVERTICES 1 5\n4 0 1 2 3\n"
             "LINES 3 9\n2 0 1\n2 1 2\n2 1 3\nPOINT_DATA 4\nSCALARS radius double 1\n"
             "LOOKUP_TABLE default\n.5\n.5\n.25\n.125\n";

static const char TREE[] = "# tree\n1 0 0 0 0 1 -1\n2 0 1 0 0 .5 1\n3 0 0 1 0 .5 1\n"
                           "4 0 0 2 0 .25 3\n5 0 9 9 9 1 -1\n";

/* Truncated files and files with changed bytes are read or rejected. */
static void damage(const char *good, size_t size_of_good) {
    starg_context *context = test_context(1);
    char text[sizeof GOOD];
    for (size_t i = 0; i < 4000; i++) {
        starg_rng rng = starg_rng_make(3, 1, i);
        size_t size = size_of_good - 1;
        memcpy(text, good, size_of_good);
        if (i < size)
            size = i;
        else
            for (int k = 0; k < 3; k++)
                text[starg_rng_below(&rng, size)] = (char)starg_rng_below(&rng, 128);
        starg_skeleton *s = NULL;
        starg_status status = starg_skeleton_read_memory(context, text, size, "damaged", &s);
        assert_true(status == STARG_OK || status == STARG_ERROR_FORMAT);
        for (size_t e = 0; s != NULL && e < 2 * s->edge_count; e++)
            assert_true(s->edges[e] < s->node_count);
        starg_skeleton_free(context, s);
    }
    test_context_free(context);
}

static void damaged_files(void **state) {
    (void)state;
    damage(GOOD, sizeof GOOD);
    damage(TREE, sizeof TREE);
}

static void scarce_memory(void **state) {
    (void)state;
    starg_status status = STARG_ERROR_MEMORY;
    for (size_t limit = 1; status != STARG_OK; limit++) {
        size_t left = limit;
        starg_context *context = test_scarce_context(1, &left);
        starg_skeleton *s = NULL;
        status = read_text(context, GOOD, &s);
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        starg_skeleton_free(context, s);
        test_context_free(context);
        assert_true(limit < 100);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(round_trips),   cmocka_unit_test(polylines),
        cmocka_unit_test(refusals),      cmocka_unit_test(damaged_files),
        cmocka_unit_test(scarce_memory), cmocka_unit_test(trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
