/* SPDX-License-Identifier: Apache-2.0 */
/* Each repair operation on meshes with one known fault, and its report. */
#include "starguard/repair.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"
#include "starguard/check.h"
#include "support.h"

/* ---- helpers ---- */

typedef struct repaired {
    starg_context *context;
    starg_mesh *input, *mesh;
    starg_check *check;
    starg_repair_report report;
} repaired;

static shape shape_of(const double *vertices, size_t vertex_count, const uint32_t *faces,
                      size_t face_count) {
    shape s = {vertex_count, face_count, malloc(3 * vertex_count * sizeof *vertices + 1),
               malloc(3 * face_count * sizeof *faces + 1)};
    memcpy(s.vertices, vertices, 3 * vertex_count * sizeof *vertices);
    memcpy(s.faces, faces, 3 * face_count * sizeof *faces);
    return s;
}

static void add_face(shape *s, uint32_t a, uint32_t b, uint32_t c) {
    s->faces = realloc(s->faces, 3 * (s->face_count + 1) * sizeof *s->faces);
    memcpy(s->faces + 3 * s->face_count++, (const uint32_t[3]){a, b, c}, 3 * sizeof(uint32_t));
}

static void add_vertex(shape *s, double x, double y, double z) {
    s->vertices = realloc(s->vertices, 3 * (s->vertex_count + 1) * sizeof *s->vertices);
    memcpy(s->vertices + 3 * s->vertex_count++, (const double[3]){x, y, z}, 3 * sizeof(double));
}

/* Removes the face; the last one takes its place. */
static void remove_face(shape *s, size_t face) {
    memmove(s->faces + 3 * face, s->faces + 3 * --s->face_count, 3 * sizeof *s->faces);
}

static void turn_face(shape *s, size_t face) {
    uint32_t swap = s->faces[3 * face];
    s->faces[3 * face] = s->faces[3 * face + 1];
    s->faces[3 * face + 1] = swap;
}

/* Repairs a shape, frees it, and asserts the properties of every success: a usable solid with
 * oriented shells, and a consistent report. */
static repaired repair_with(shape *s, const starg_repair_options *options) {
    repaired r = {.context = test_context(1)};
    r.input = test_mesh_of(r.context, s);
    test_ok(r.context, starg_mesh_repair(r.context, r.input, options, &r.mesh, &r.report));
    test_ok(r.context, starg_mesh_check(r.context, r.mesh, &r.check));
    assert_true(r.check->usable);
    assert_int_equal(r.check->findings[STARG_FINDING_INWARD_COMPONENT].count, 0);
    assert_int_equal(r.check->findings[STARG_FINDING_ISOLATED_VERTEX].count, 0);
    assert_int_equal(r.check->findings[STARG_FINDING_SELF_INTERSECTION].count,
                     r.report.intersections_after);
    assert_int_equal(s->face_count + r.report.faces_added, r.check->faces + r.report.faces_dropped);
    assert_int_equal(s->vertex_count + r.report.vertices_added + r.report.vertices_split,
                     r.check->vertices + r.report.vertices_merged + r.report.vertices_dropped);
    assert_int_equal(r.report.vertices_moved > 0, r.report.largest_move > 0);
    shape_free(s);
    return r;
}

static repaired repair(shape *s) {
    return repair_with(s, NULL);
}

static void repaired_free(repaired *r) {
    starg_check_free(r->context, r->check);
    starg_mesh_free(r->input);
    starg_mesh_free(r->mesh);
    test_context_free(r->context);
}

static void expect_volume(const repaired *r, double volume) {
    if (!(fabs(r->check->volume - volume) <= 1e-9 * volume))
        fail_msg("volume %.17g, %.17g expected", r->check->volume, volume);
}

static void expect_failure(shape *s, const starg_repair_options *options, starg_status expected,
                           const char *phrase) {
    starg_context *context = test_context(1);
    starg_mesh *mesh, *out;
    starg_repair_report report;
    mesh = test_mesh_of(context, s);
    assert_int_equal(starg_mesh_repair(context, mesh, options, &out, &report), expected);
    assert_null(out);
    if (strstr(starg_context_error(context)->message, phrase) == NULL)
        fail_msg("'%s' is not in '%s'", phrase, starg_context_error(context)->message);
    starg_mesh_free(mesh);
    test_context_free(context);
    shape_free(s);
}

/* ---- nothing to do ---- */

static void test_sound_meshes_come_back(void **state) {
    (void)state;
    shape shapes[] = {shape_tetrahedron(), shape_cube(2),   shape_room(),
                      shape_cavity(),      shape_columns(), shape_blob(3, 1)};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        repaired r = repair(&shapes[i]);
        starg_repair_report none = {.closed_before = true};
        expect_volume(&r, starg_mesh_volume(r.input));
        none.enclosed_before = none.enclosed_after = r.report.enclosed_after;
        assert_true(test_same_mesh(r.input, r.mesh));
        assert_memory_equal(&r.report, &none, sizeof none);
        repaired_free(&r);
    }
}

/* ---- one fault each ---- */

static void test_welds_a_soup(void **state) {
    (void)state;
    shape cube = shape_cube(2), soup = {0};
    for (size_t i = 0; i < 3 * cube.face_count; i++) {
        const double *p = cube.vertices + 3 * (size_t)cube.faces[i];
        add_vertex(&soup, p[0], p[1], p[2] == 0 ? -0.0 : p[2]);
        if (i % 3 == 2)
            add_face(&soup, (uint32_t)i - 2, (uint32_t)i - 1, (uint32_t)i);
    }
    size_t corners = 3 * cube.face_count;
    repaired r = repair(&soup);
    assert_int_equal(r.report.vertices_merged, corners - cube.vertex_count);
    assert_int_equal(r.report.faces_dropped + r.report.faces_added + r.report.faces_turned, 0);
    assert_int_equal(r.check->vertices, cube.vertex_count);
    assert_true(r.check->embedded);
    expect_volume(&r, 8);
    repaired_free(&r);
    shape_free(&cube);
}

static void test_merges_within_a_distance(void **state) {
    (void)state;
    shape cube = shape_cube(1), soup = {0};
    starg_rng rng = starg_rng_make(3, 0, 0);
    for (size_t i = 0; i < 3 * cube.face_count; i++) {
        const double *p = cube.vertices + 3 * (size_t)cube.faces[i];
        add_vertex(&soup, p[0] + 1e-4 * starg_rng_unit(&rng), p[1] + 1e-4 * starg_rng_unit(&rng),
                   p[2] + 1e-4 * starg_rng_unit(&rng));
        if (i % 3 == 2)
            add_face(&soup, (uint32_t)i - 2, (uint32_t)i - 1, (uint32_t)i);
    }
    starg_repair_options options;
    starg_repair_options_default(&options);
    options.merge_distance = 1e-3;
    repaired r = repair_with(&soup, &options);
    assert_int_equal(r.report.vertices_merged, 36 - 8);
    assert_int_equal(r.check->vertices, 8);
    assert_int_equal(r.check->faces, 12);
    assert_true(r.report.largest_move == 0);
    assert_true(fabs(r.check->volume - 1) < 1e-3);
    repaired_free(&r);
    shape_free(&cube);
}

static void test_drops_what_does_not_belong(void **state) {
    (void)state;
    shape s = shape_tetrahedron();
    add_vertex(&s, 9, 9, 9); /* isolated */
    add_face(&s, 0, 2, 0);   /* repeated corner */
    add_face(&s, 2, 3, 1);   /* duplicate */
    add_face(&s, 3, 1, 2);   /* and once more */
    add_vertex(&s, 5, 5, 1);
    add_face(&s, 1, 2, 5); /* a fin */
    repaired r = repair(&s);
    assert_int_equal(r.report.faces_dropped, 4);
    assert_int_equal(r.report.vertices_dropped, 2);
    assert_int_equal(r.report.faces_added + r.report.faces_turned, 0);
    assert_true(r.check->embedded);
    expect_volume(&r, 64.0 / 6);
    repaired_free(&r);
}

/* Every face doubled from behind: one layer is kept. */
static void test_keeps_one_layer(void **state) {
    (void)state;
    shape s = shape_columns();
    size_t faces = s.face_count;
    for (size_t f = 0; f < faces; f++) {
        const uint32_t *corner = s.faces + 3 * f;
        add_face(&s, corner[2], corner[1], corner[0]);
    }
    repaired r = repair(&s);
    assert_int_equal(r.report.faces_dropped, faces);
    assert_int_equal(r.check->faces, faces);
    assert_int_equal(r.check->genus, 4);
    expect_volume(&r, 42);
    repaired_free(&r);
}

/* Two cubes with a doubled wall between them: the wall is dropped. */
static void test_drops_a_wall_inside(void **state) {
    (void)state;
    shape s = shape_cells("##", 2, 1, 1);
    uint32_t wall[4];
    size_t count = 0;
    for (uint32_t v = 0; v < s.vertex_count; v++)
        if (s.vertices[3 * (size_t)v] == 1)
            wall[count++] = v;
    assert_int_equal(count, 4);
    /* order around the square */
    uint32_t ring[4] = {wall[0], 0, 0, 0};
    for (size_t i = 1, at = 1; i < 4; i++) {
        const double *p = s.vertices + 3 * (size_t)wall[0], *q = s.vertices + 3 * (size_t)wall[i];
        bool opposite = p[1] != q[1] && p[2] != q[2];
        ring[opposite ? 2 : at] = wall[i];
        at += opposite ? 0 : 2;
    }
    for (int side = 0; side < 2; side++) {
        add_face(&s, ring[0], ring[side ? 2 : 1], ring[side ? 1 : 2]);
        add_face(&s, ring[0], ring[side ? 3 : 2], ring[side ? 2 : 3]);
    }
    repaired r = repair(&s);
    assert_int_equal(r.report.faces_dropped, 4);
    assert_int_equal(r.check->faces, 20);
    assert_true(r.check->embedded);
    expect_volume(&r, 2);
    repaired_free(&r);
}

static void test_orients(void **state) {
    (void)state;
    shape s = shape_cavity();
    size_t turned = 0;
    for (size_t f = 0; f < s.face_count; f++)
        if (starg_hash64(f) % 3 == 0) {
            turn_face(&s, f);
            turned++;
        }
    assert_true(turned > 10);
    repaired r = repair(&s);
    assert_int_equal(r.report.faces_turned, turned);
    assert_int_equal(r.check->cavities, 1);
    expect_volume(&r, 26);
    repaired_free(&r);
}

static void test_turns_shells(void **state) {
    (void)state;
    shape s = shape_cube(1), inner = shape_cube(1);
    shape_place(&s, 4, 0);
    shape_append(&s, &inner, (const double[3]){1, 1, 1}, 0);
    shape_free(&inner);
    repaired r = repair(&s);
    assert_int_equal(r.report.faces_turned, 12);
    expect_volume(&r, 63);
    repaired_free(&r);
}

/* Two cells that touch along an edge are separated there; nothing moves. */
static void test_splits_an_edge(void **state) {
    (void)state;
    shape s = shape_cells("#..#", 2, 2, 1);
    repaired r = repair(&s);
    assert_int_equal(r.report.vertices_split, 2);
    assert_int_equal(r.check->components, 2);
    assert_int_equal(r.check->faces, 24);
    assert_int_equal(r.report.intersections_after, 0);
    assert_true(r.report.largest_move == 0);
    expect_volume(&r, 2);
    repaired_free(&r);
}

static void test_splits_a_vertex(void **state) {
    (void)state;
    shape s = shape_cells("#......#", 2, 2, 2);
    repaired r = repair(&s);
    assert_int_equal(r.report.vertices_split, 1);
    assert_int_equal(r.check->components, 2);
    expect_volume(&r, 2);
    repaired_free(&r);
}

/* A ring of cells whose first and last touch along an edge: both sheets of the edge share both
 * ends, so copying the vertices does not separate them. */
static void test_splits_a_pinched_edge(void **state) {
    (void)state;
    shape s = shape_cells(".#"
                          "#."
                          "##"
                          "##",
                          2, 2, 2);
    repaired r = repair(&s);
    assert_true(r.check->closed && r.check->manifold);
    expect_volume(&r, 6);
    repaired_free(&r);
}

static void test_flips_degenerate_faces(void **state) {
    (void)state;
    shape s = shape_tetrahedron(); /* with edge 1 2 cut on one side only */
    add_vertex(&s, 2, 2, 0);
    memcpy(s.faces, (const uint32_t[3]){0, 2, 4}, 3 * sizeof(uint32_t));
    add_face(&s, 0, 4, 1);
    add_face(&s, 2, 1, 4);
    repaired r = repair(&s);
    assert_true(r.check->embedded);
    assert_int_equal(r.check->faces, 6);
    assert_true(r.report.largest_move == 0);
    expect_volume(&r, 64.0 / 6);
    repaired_free(&r);
}

/* ---- holes ---- */

static void test_fills_every_single_hole(void **state) {
    (void)state;
    shape whole = shape_columns();
    for (size_t f = 0; f < whole.face_count; f += 7) {
        shape s = shape_of(whole.vertices, whole.vertex_count, whole.faces, whole.face_count);
        remove_face(&s, f);
        repaired r = repair(&s);
        assert_int_equal(r.report.holes_filled, 1);
        assert_int_equal(r.report.faces_added, 1);
        assert_true(r.check->embedded);
        expect_volume(&r, 42);
        repaired_free(&r);
    }
    shape_free(&whole);
}

/* Two holes that meet in a corner: the corner stays one vertex. */
static void test_fills_holes_that_meet(void **state) {
    (void)state;
    shape s = shape_cube(4);
    size_t removed = 0;
    for (size_t f = s.face_count; f-- > 0;) {
        double low[3] = {9, 9, 9}, high[3] = {-9, -9, -9};
        for (size_t i = 0; i < 9; i++) {
            double x = s.vertices[3 * (size_t)s.faces[3 * f + i / 3] + i % 3];
            low[i % 3] = fmin(low[i % 3], x);
            high[i % 3] = fmax(high[i % 3], x);
        }
        bool first = high[0] <= 2 && high[1] <= 2 && low[0] >= 1 && low[1] >= 1;
        bool second = high[0] <= 3 && high[1] <= 3 && low[0] >= 2 && low[1] >= 2;
        if (low[2] == 4 && (first || second)) {
            remove_face(&s, f);
            removed++;
        }
    }
    assert_int_equal(removed, 4);
    repaired r = repair(&s);
    assert_int_equal(r.report.holes_filled, 2);
    assert_int_equal(r.report.faces_added, 4);
    assert_int_equal(r.report.vertices_split, 0);
    assert_true(r.check->embedded);
    expect_volume(&r, 64);
    repaired_free(&r);
}

/* A flat concave hole is filled flat: the lid of an L of cells. */
static void test_fills_a_concave_hole(void **state) {
    (void)state;
    shape s = shape_room();
    for (size_t f = s.face_count; f-- > 0;) {
        bool top = true;
        for (size_t k = 0; k < 3; k++)
            top = top && s.vertices[3 * (size_t)s.faces[3 * f + k] + 2] == 1;
        if (top)
            remove_face(&s, f);
    }
    repaired r = repair(&s);
    assert_int_equal(r.report.holes_filled, 1);
    assert_int_equal(r.report.intersections_after, 0);
    assert_int_equal(r.check->findings[STARG_FINDING_DEGENERATE_FACE].count, 0);
    expect_volume(&r, 7);
    repaired_free(&r);
}

/* A drum with n sides without its lid; n also beyond the limit of the exact filling. */
static void test_fills_large_holes(void **state) {
    (void)state;
    static const uint32_t sides[] = {3, 4, 50, 192, 1000};
    for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
        uint32_t n = sides[i];
        shape s = {0};
        add_vertex(&s, 0, 0, -1);
        for (uint32_t k = 0; k < n; k++) {
            double angle = 2 * 3.14159265358979 * k / n;
            add_vertex(&s, cos(angle), sin(angle), 1e-3 * (double)(starg_hash64(k) % 8));
        }
        for (uint32_t k = 0; k < n; k++)
            add_face(&s, 0, 1 + (k + 1) % n, 1 + k);
        repaired r = repair(&s);
        assert_int_equal(r.report.holes_filled, 1);
        /* two more with a vertex in the middle */
        assert_int_equal(r.report.faces_added, n - 2 + 2 * r.report.vertices_added);
        assert_int_equal(r.check->genus, 0);
        assert_int_equal(r.report.intersections_after, 0);
        repaired_free(&r);
    }
}

static void test_leaves_holes_beyond_the_limit(void **state) {
    (void)state;
    starg_repair_options options;
    starg_repair_options_default(&options);
    options.max_hole_edges = 3;
    shape s = shape_cube(1);
    remove_face(&s, 0);
    repaired r = repair_with(&s, &options);
    assert_int_equal(r.report.holes_filled, 1);
    repaired_free(&r);
    s = shape_cube(1);
    remove_face(&s, 1);
    remove_face(&s, 0);
    expect_failure(&s, &options, STARG_ERROR_MESH, "open edges");
}

/* ---- intersections ---- */

/* A vertex of a fine blob pushed through the opposite wall. */
static void test_untangles_a_spike(void **state) {
    (void)state;
    shape s = shape_blob(4, 2);
    for (size_t v = 0; v < s.vertex_count; v++) {
        double *p = s.vertices + 3 * v, r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int k = 0; k < 3; k++)
            p[k] /= r;
    }
    for (int k = 0; k < 3; k++)
        s.vertices[k] *= -1.25;
    repaired r = repair(&s);
    assert_true(r.report.intersections_before > 0);
    assert_int_equal(r.report.intersections_after, 0);
    assert_true(fabs(r.check->volume - 4.1) < 0.15);
    assert_int_equal(r.check->genus, 0);
    repaired_free(&r);
}

/* Random noise on a sphere folds faces over one another: repair reduces crossings, never adds any,
 * and moves no vertex far. */
static void test_untangles_folds(void **state) {
    (void)state;
    for (uint64_t round = 0; round < 5; round++) {
        starg_rng rng = starg_rng_make(7, 0, round);
        shape s = shape_blob(4, 2);
        for (size_t v = 0; v < s.vertex_count; v++) {
            double *p = s.vertices + 3 * v, r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            for (int k = 0; k < 3; k++)
                p[k] = p[k] / r + (v % 20 == 0 ? 0.4 * (starg_rng_unit(&rng) - 0.5) : 0);
        }
        repaired r = repair(&s);
        assert_true(r.report.intersections_before > 0);
        assert_int_equal(r.report.intersections_after, 0);
        assert_true(r.report.largest_move <= 0.0101 * r.check->diagonal);
        repaired_free(&r);
    }
}

static void test_leaves_overlapping_components(void **state) {
    (void)state;
    shape s = shape_cube(2), other = shape_cube(2);
    shape_append(&s, &other, (const double[3]){0.75, 0.5, 0.25}, 0);
    shape_free(&other);
    repaired r = repair(&s);
    assert_true(r.report.intersections_after > 0);
    assert_int_equal(r.report.intersections_after, r.report.intersections_before);
    assert_true(test_same_mesh(r.input, r.mesh));
    repaired_free(&r);
}

/* ---- what cannot be repaired ---- */

static void test_refuses_a_moebius_strip(void **state) {
    (void)state;
    shape s = {0};
    uint32_t n = 12;
    for (uint32_t i = 0; i < n; i++) {
        double a = 2 * 3.14159265358979 * i / n;
        for (int side = -1; side <= 1; side += 2) {
            double r = 3 + side * cos(a / 2);
            add_vertex(&s, r * cos(a), r * sin(a), side * sin(a / 2));
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t a = 2 * i, b = 2 * i + 1, c = (2 * i + 2) % (2 * n), d = (2 * i + 3) % (2 * n);
        if (i == n - 1) {
            c = 1;
            d = 0;
        }
        add_face(&s, a, b, c);
        add_face(&s, b, d, c);
    }
    expect_failure(&s, NULL, STARG_ERROR_MESH, "one-sided");
}

static void test_refuses_what_encloses_nothing(void **state) {
    (void)state;
    shape s = {0};
    for (uint32_t i = 0; i < 5; i++) {
        add_vertex(&s, i, 0, 0);
        add_vertex(&s, i + 0.5, 0.25, 0);
        add_vertex(&s, i, 0, 1 + i);
        add_face(&s, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    expect_failure(&s, NULL, STARG_ERROR_MESH, "5 components are flat");
    s = (shape){0};
    expect_failure(&s, NULL, STARG_ERROR_MESH, "no faces");
}

static void test_refuses_bad_options(void **state) {
    (void)state;
    static const double bad[] = {-1e-3, 1.5, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        starg_repair_options options;
        starg_repair_options_default(&options);
        options.merge_distance = bad[i];
        shape s = shape_tetrahedron();
        expect_failure(&s, &options, STARG_ERROR_ARGUMENT, "merge distance");
    }
}

static void test_cancel(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *mesh, *out;
    starg_repair_report report;
    shape s = shape_cube(1);
    remove_face(&s, 0);
    mesh = test_mesh_of(context, &s);
    starg_context_cancel(context);
    assert_int_equal(starg_mesh_repair(context, mesh, NULL, &out, &report), STARG_ERROR_CANCELLED);
    assert_null(out);
    starg_context_reset(context);
    test_ok(context, starg_mesh_repair(context, mesh, NULL, &out, &report));
    starg_mesh_free(out);
    starg_mesh_free(mesh);
    shape_free(&s);
    test_context_free(context);
}

/* ---- random damage: no crash, no additional faults, repeatable ---- */

static shape damaged(uint64_t round) {
    starg_rng rng = starg_rng_make(11, 0, round);
    shape s = round % 2 ? shape_columns() : shape_cavity();
    size_t changes = 1 + (size_t)starg_rng_below(&rng, 12);
    for (size_t i = 0; i < changes; i++) {
        size_t f = (size_t)starg_rng_below(&rng, s.face_count);
        uint32_t *corner = s.faces + 3 * f;
        uint32_t any = (uint32_t)starg_rng_below(&rng, s.vertex_count);
        switch (starg_rng_below(&rng, 6)) {
        case 0:
            remove_face(&s, f);
            break;
        case 1:
            turn_face(&s, f);
            break;
        case 2:
            add_face(&s, corner[1], corner[0], corner[2]);
            break;
        case 3:
            add_face(&s, corner[0], corner[1], any);
            break;
        case 4:
            corner[starg_rng_below(&rng, 3)] = any;
            break;
        default:
            s.vertices[3 * (size_t)any + (size_t)starg_rng_below(&rng, 3)] +=
                (double)starg_rng_below(&rng, 3) - 1;
        }
    }
    shape_place(&s, (const double[]){1, 1e-70, 1e90}[round % 3], 0);
    return s;
}

static void test_random_damage(void **state) {
    (void)state;
    size_t mended = 0, rounds = test_rounds(30, 60);
    for (uint64_t round = 0; round < rounds; round++) {
        starg_context *context = test_context(1);
        shape s = damaged(round);
        starg_mesh *mesh, *first, *second;
        starg_check *check;
        starg_repair_report report, again;
        mesh = test_mesh_of(context, &s);
        starg_status status = starg_mesh_repair(context, mesh, NULL, &first, &report);
        assert_true(status == STARG_OK || status == STARG_ERROR_MESH);
        if (status == STARG_OK) {
            test_ok(context, starg_mesh_check(context, first, &check));
            assert_true(check->usable);
            assert_int_equal(check->findings[STARG_FINDING_INWARD_COMPONENT].count, 0);
            test_ok(context, starg_mesh_repair(context, mesh, NULL, &second, &again));
            assert_true(test_same_mesh(first, second));
            assert_memory_equal(&report, &again, sizeof report);
            starg_check_free(context, check);
            starg_mesh_free(first);
            starg_mesh_free(second);
            mended++;
        }
        starg_mesh_free(mesh);
        shape_free(&s);
        test_context_free(context);
    }
    assert_true(mended + 2 >= rounds);
}

/* ---- memory ---- */

static void test_every_allocation_fails_once(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(0, &left);
    starg_mesh *mesh, *out;
    starg_repair_report report;
    shape s = shape_cells("#..#", 2, 2, 1), cube = shape_cube(1);
    s.vertices[0] += 3; /* crossing faces */
    shape_append(&s, &cube, (const double[3]){9, 0, 0}, 1);
    remove_face(&s, s.face_count - 1);
    remove_face(&s, s.face_count - 3);
    mesh = test_mesh_of(context, &s);
    size_t before = starg_context_live_blocks(context), failures = 0;
    for (;; failures++) {
        left = failures;
        starg_status status = starg_mesh_repair(context, mesh, NULL, &out, &report);
        if (status == STARG_OK)
            break;
        assert_int_equal(status, STARG_ERROR_MEMORY);
        assert_null(out);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    assert_true(failures > 100);
    left = SIZE_MAX;
    starg_mesh_free(out);
    starg_mesh_free(mesh);
    shape_free(&s);
    shape_free(&cube);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sound_meshes_come_back),
        cmocka_unit_test(test_welds_a_soup),
        cmocka_unit_test(test_merges_within_a_distance),
        cmocka_unit_test(test_drops_what_does_not_belong),
        cmocka_unit_test(test_keeps_one_layer),
        cmocka_unit_test(test_drops_a_wall_inside),
        cmocka_unit_test(test_orients),
        cmocka_unit_test(test_turns_shells),
        cmocka_unit_test(test_splits_an_edge),
        cmocka_unit_test(test_splits_a_vertex),
        cmocka_unit_test(test_splits_a_pinched_edge),
        cmocka_unit_test(test_flips_degenerate_faces),
        cmocka_unit_test(test_fills_every_single_hole),
        cmocka_unit_test(test_fills_holes_that_meet),
        cmocka_unit_test(test_fills_a_concave_hole),
        cmocka_unit_test(test_fills_large_holes),
        cmocka_unit_test(test_leaves_holes_beyond_the_limit),
        cmocka_unit_test(test_untangles_a_spike),
        cmocka_unit_test(test_untangles_folds),
        cmocka_unit_test(test_leaves_overlapping_components),
        cmocka_unit_test(test_refuses_a_moebius_strip),
        cmocka_unit_test(test_refuses_what_encloses_nothing),
        cmocka_unit_test(test_refuses_bad_options),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_random_damage),
        cmocka_unit_test(test_every_allocation_fails_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
