/* SPDX-License-Identifier: Apache-2.0 */
/* The check: every kind of finding on meshes small enough to count by hand, and intersections of
 * random meshes against exact arithmetic over all pairs. */
#include "starguard/check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "mesh/examine.h"
#include "mesh/topology.h"
#include "shapes.h"
#include "support.h"

/* ---- helpers ---- */

typedef struct checked {
    starg_context *context;
    starg_mesh *mesh;
    starg_check *check;
} checked;

static checked check_arrays(const double *vertices, size_t vertex_count, const uint32_t *faces,
                            size_t face_count) {
    checked c = {.context = test_context(1)};
    test_ok(c.context,
            starg_mesh_create(c.context, vertices, vertex_count, faces, face_count, &c.mesh));
    test_ok(c.context, starg_mesh_check(c.context, c.mesh, &c.check));
    assert_int_equal(c.check->vertices, vertex_count);
    assert_int_equal(c.check->faces, face_count);
    return c;
}

static checked check_shape(shape *s) {
    checked c = check_arrays(s->vertices, s->vertex_count, s->faces, s->face_count);
    shape_free(s);
    return c;
}

static void checked_free(checked *c) {
    starg_check_free(c->context, c->check);
    starg_mesh_free(c->mesh);
    test_context_free(c->context);
}

/* Asserts count and first indices of one kind. */
static void expect(const checked *c, starg_finding_kind kind, size_t count, starg_element element,
                   size_t shown, const uint64_t *first) {
    const starg_finding *found = &c->check->findings[kind];
    if (found->count != count)
        fail_msg("%zu %s, %zu expected", found->count, starg_finding_name(kind), count);
    if (count == 0)
        return;
    assert_int_equal(found->element, element);
    assert_int_equal(found->shown, shown);
    for (size_t i = 0; i < shown; i++)
        assert_int_equal(found->first[i], first[i]);
}

#define EXPECT(C, KIND, COUNT, ELEMENT, ...)                                                       \
    expect((C), (KIND), (COUNT), (ELEMENT), sizeof((uint64_t[]){__VA_ARGS__}) / sizeof(uint64_t),  \
           (const uint64_t[]){__VA_ARGS__})

/* Asserts that only the kinds in the mask are found. */
static void expect_only(const checked *c, unsigned mask) {
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++)
        if (c->check->findings[kind].count != 0 && !(mask >> kind & 1))
            fail_msg("%zu unexpected %s", c->check->findings[kind].count,
                     starg_finding_name((starg_finding_kind)kind));
}

static const double TETRAHEDRON[12] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4};
static const uint32_t TETRAHEDRON_FACES[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

/* ---- sound meshes ---- */

static void test_tetrahedron(void **state) {
    (void)state;
    checked c = check_arrays(TETRAHEDRON, 4, TETRAHEDRON_FACES, 4);
    expect_only(&c, 0);
    assert_true(c.check->closed && c.check->manifold && c.check->oriented && c.check->embedded);
    assert_true(c.check->usable);
    assert_int_equal(c.check->edges, 6);
    assert_int_equal(c.check->components, 1);
    assert_int_equal(c.check->cavities, 0);
    assert_int_equal(c.check->genus, 0);
    assert_true(fabs(c.check->volume - 64.0 / 6) < 1e-12);
    assert_true(fabs(c.check->area - (24 + 8 * sqrt(3))) < 1e-12);
    assert_true(fabs(c.check->diagonal - sqrt(48)) < 1e-12);
    for (int f = 0; f < 4; f++)
        assert_int_equal(c.check->face_marks[f], 0);
    checked_free(&c);
}

static void test_genus(void **state) {
    (void)state;
    shape ring = shape_cells("####.####", 3, 3, 1);
    checked c = check_shape(&ring);
    expect_only(&c, 0);
    assert_int_equal(c.check->genus, 1);
    assert_true(fabs(c.check->volume - (8)) < 1e-10);
    checked_free(&c);

    shape columns = shape_columns();
    c = check_shape(&columns);
    expect_only(&c, 0);
    assert_true(c.check->usable);
    assert_int_equal(c.check->genus, 4);
    checked_free(&c);

    /* two separate rings */
    shape pair = shape_cells("####.####", 3, 3, 1), other = shape_cells("####.####", 3, 3, 1);
    shape_append(&pair, &other, (const double[3]){9, 0, 0}, 0);
    shape_free(&other);
    c = check_shape(&pair);
    assert_int_equal(c.check->components, 2);
    assert_int_equal(c.check->genus, 2);
    checked_free(&c);
}

static void test_no_faces(void **state) {
    (void)state;
    checked c = check_arrays(TETRAHEDRON, 4, NULL, 0);
    EXPECT(&c, STARG_FINDING_ISOLATED_VERTEX, 4, STARG_ELEMENT_VERTEX, 0, 1, 2, 3);
    assert_false(c.check->closed);
    assert_false(c.check->usable);
    assert_int_equal(c.check->components, 0);
    assert_int_equal(c.check->genus, -1);
    checked_free(&c);
    c = check_arrays(NULL, 0, NULL, 0);
    expect_only(&c, 0);
    assert_false(c.check->usable);
    checked_free(&c);
}

/* ---- one kind at a time ---- */

static void test_open_edges(void **state) {
    (void)state;
    checked c = check_arrays(TETRAHEDRON, 4, TETRAHEDRON_FACES, 3);
    EXPECT(&c, STARG_FINDING_OPEN_EDGE, 3, STARG_ELEMENT_EDGE, 1, 2, 1, 3, 2, 3);
    expect_only(&c, 1u << STARG_FINDING_OPEN_EDGE);
    assert_false(c.check->closed);
    assert_true(c.check->manifold && c.check->oriented);
    assert_false(c.check->usable);
    assert_int_equal(c.check->genus, -1);
    for (int f = 0; f < 3; f++)
        assert_int_equal(c.check->face_marks[f], 1 + STARG_FINDING_OPEN_EDGE);
    checked_free(&c);
}

/* A fifth vertex and a fin on edge 1 2. */
static void test_nonmanifold_edge(void **state) {
    (void)state;
    double vertices[15];
    uint32_t faces[15];
    memcpy(vertices, TETRAHEDRON, sizeof TETRAHEDRON);
    memcpy(faces, TETRAHEDRON_FACES, sizeof TETRAHEDRON_FACES);
    memcpy(vertices + 12, (const double[3]){5, 5, 1}, 3 * sizeof(double));
    memcpy(faces + 12, (const uint32_t[3]){1, 2, 4}, 3 * sizeof(uint32_t));
    checked c = check_arrays(vertices, 5, faces, 5);
    EXPECT(&c, STARG_FINDING_NONMANIFOLD_EDGE, 1, STARG_ELEMENT_EDGE, 1, 2);
    EXPECT(&c, STARG_FINDING_OPEN_EDGE, 2, STARG_ELEMENT_EDGE, 2, 4, 1, 4);
    EXPECT(&c, STARG_FINDING_NONMANIFOLD_VERTEX, 2, STARG_ELEMENT_VERTEX, 1, 2);
    expect_only(&c, 1u << STARG_FINDING_NONMANIFOLD_EDGE | 1u << STARG_FINDING_OPEN_EDGE |
                        1u << STARG_FINDING_NONMANIFOLD_VERTEX);
    assert_int_equal(c.check->face_marks[0], 1 + STARG_FINDING_NONMANIFOLD_EDGE);
    assert_int_equal(c.check->face_marks[4], 1 + STARG_FINDING_OPEN_EDGE);
    checked_free(&c);
}

/* Two tetrahedra that share vertex 0. */
static void test_nonmanifold_vertex(void **state) {
    (void)state;
    const double vertices[21] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4, -4, 0, 0, 0, -4, 0, 0, 0, -4};
    const uint32_t faces[24] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3,
                                0, 4, 5, 0, 6, 4, 0, 5, 6, 4, 6, 5};
    checked c = check_arrays(vertices, 7, faces, 8);
    EXPECT(&c, STARG_FINDING_NONMANIFOLD_VERTEX, 1, STARG_ELEMENT_VERTEX, 0);
    expect_only(&c, 1u << STARG_FINDING_NONMANIFOLD_VERTEX);
    assert_true(c.check->closed);
    assert_false(c.check->manifold);
    assert_true(c.check->usable); /* two solids that touch */
    assert_true(fabs(c.check->volume - 64 / 3.0) < 1e-12);
    assert_int_equal(c.check->components, 2);
    assert_int_equal(c.check->face_marks[0], 1 + STARG_FINDING_NONMANIFOLD_VERTEX);
    assert_int_equal(c.check->face_marks[3], 0);
    checked_free(&c);
}

static void test_inconsistent_edges(void **state) {
    (void)state;
    uint32_t faces[12];
    memcpy(faces, TETRAHEDRON_FACES, sizeof faces);
    faces[10] = 3;
    faces[11] = 2;
    checked c = check_arrays(TETRAHEDRON, 4, faces, 4);
    EXPECT(&c, STARG_FINDING_INCONSISTENT_EDGE, 3, STARG_ELEMENT_EDGE, 1, 2, 1, 3, 2, 3);
    expect_only(&c, 1u << STARG_FINDING_INCONSISTENT_EDGE);
    assert_true(c.check->closed && c.check->manifold);
    assert_false(c.check->oriented);
    assert_false(c.check->usable);
    assert_int_equal(c.check->genus, 0);
    checked_free(&c);
}

static void test_repeated_corner(void **state) {
    (void)state;
    uint32_t faces[15];
    memcpy(faces, TETRAHEDRON_FACES, sizeof TETRAHEDRON_FACES);
    memcpy(faces + 12, (const uint32_t[3]){3, 1, 3}, 3 * sizeof(uint32_t));
    checked c = check_arrays(TETRAHEDRON, 4, faces, 5);
    EXPECT(&c, STARG_FINDING_REPEATED_CORNER, 1, STARG_ELEMENT_FACE, 4);
    assert_false(c.check->manifold);
    assert_false(c.check->usable);
    assert_int_not_equal(c.check->face_marks[4], 0);
    checked_free(&c);
}

static void test_degenerate_face(void **state) {
    (void)state;
    /* face 0 2 1 of the tetrahedron is cut at 4, the midpoint of edge 1 2, without opening an edge:
     * the flat face 1 2 4 closes the gap to face 1 2 3 */
    double vertices[15];
    memcpy(vertices, TETRAHEDRON, sizeof TETRAHEDRON);
    memcpy(vertices + 12, (const double[3]){2, 2, 0}, 3 * sizeof(double));
    const uint32_t faces[18] = {0, 2, 4, 0, 4, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 2, 1, 4};
    checked c = check_arrays(vertices, 5, faces, 6);
    EXPECT(&c, STARG_FINDING_DEGENERATE_FACE, 1, STARG_ELEMENT_FACE, 5);
    assert_true(c.check->closed && c.check->manifold && c.check->oriented);
    assert_true(c.check->usable);
    assert_false(c.check->embedded);
    assert_int_equal(c.check->face_marks[5], 1 + STARG_FINDING_DEGENERATE_FACE);
    checked_free(&c);
}

static void test_duplicate_face(void **state) {
    (void)state;
    uint32_t faces[18];
    memcpy(faces, TETRAHEDRON_FACES, sizeof TETRAHEDRON_FACES);
    memcpy(faces + 12, (const uint32_t[6]){3, 1, 2, 3, 2, 1}, 6 * sizeof(uint32_t));
    checked c = check_arrays(TETRAHEDRON, 4, faces, 6);
    EXPECT(&c, STARG_FINDING_DUPLICATE_FACE, 2, STARG_ELEMENT_FACE, 4, 5);
    EXPECT(&c, STARG_FINDING_NONMANIFOLD_EDGE, 3, STARG_ELEMENT_EDGE, 1, 2, 1, 3, 2, 3);
    EXPECT(&c, STARG_FINDING_SELF_INTERSECTION, 3, STARG_ELEMENT_FACE, 3, 4, 3, 5, 4, 5);
    checked_free(&c);
}

static void test_duplicate_and_isolated_vertices(void **state) {
    (void)state;
    double vertices[18];
    memcpy(vertices, TETRAHEDRON, sizeof TETRAHEDRON);
    memcpy(vertices + 12, (const double[6]){-0.0, 4, 0, 9, 9, 9}, 6 * sizeof(double));
    checked c = check_arrays(vertices, 6, TETRAHEDRON_FACES, 4);
    EXPECT(&c, STARG_FINDING_DUPLICATE_VERTEX, 1, STARG_ELEMENT_VERTEX, 4);
    EXPECT(&c, STARG_FINDING_ISOLATED_VERTEX, 2, STARG_ELEMENT_VERTEX, 4, 5);
    expect_only(&c, 1u << STARG_FINDING_DUPLICATE_VERTEX | 1u << STARG_FINDING_ISOLATED_VERTEX);
    assert_true(c.check->usable && c.check->embedded);
    assert_int_equal(c.check->genus, 0);
    checked_free(&c);
}

/* ---- shells ---- */

static void test_inward(void **state) {
    (void)state;
    shape s = {0}, cube = shape_cube(1);
    shape_append(&s, &cube, (const double[3]){0, 0, 0}, 0);
    shape_append(&s, &cube, (const double[3]){3, 0, 0}, 1);
    shape_free(&cube);
    checked c = check_shape(&s);
    EXPECT(&c, STARG_FINDING_INWARD_COMPONENT, 1, STARG_ELEMENT_FACE, 12);
    expect_only(&c, 1u << STARG_FINDING_INWARD_COMPONENT);
    assert_true(c.check->usable && c.check->oriented);
    assert_true(fabs(c.check->volume - (2)) < 1e-10);
    checked_free(&c);
}

/* Nested cubes of sides 9, 7, 5, 3: solid, cavity, solid, cavity. */
static void nested(int turned, size_t inward, const uint64_t *first) {
    shape s = {0};
    for (int i = 0; i < 4; i++) {
        shape cube = shape_cube(1);
        shape_place(&cube, 9 - 2 * i, i);
        shape_append(&s, &cube, (const double[3]){0, 0, 0}, turned >> i & 1);
        shape_free(&cube);
    }
    checked c = check_shape(&s);
    expect(&c, STARG_FINDING_INWARD_COMPONENT, inward, STARG_ELEMENT_FACE, inward, first);
    expect_only(&c, 1u << STARG_FINDING_INWARD_COMPONENT);
    assert_int_equal(c.check->components, 4);
    assert_int_equal(c.check->cavities, 2);
    assert_true(c.check->usable);
    assert_true(fabs(c.check->volume - (729 - 343 + 125 - 27)) < 1e-10);
    checked_free(&c);
}

static void test_nested_shells(void **state) {
    (void)state;
    nested(0xa, 0, NULL);
    nested(0x0, 2, (const uint64_t[]){12, 36});
    nested(0x8, 1, (const uint64_t[]){12});
    nested(0x5, 4, (const uint64_t[]){0, 12, 24, 36});
}

static void test_cavity(void **state) {
    (void)state;
    shape s = shape_cavity();
    checked c = check_shape(&s);
    expect_only(&c, 0);
    assert_int_equal(c.check->cavities, 1);
    assert_int_equal(c.check->components, 2);
    assert_true(fabs(c.check->volume - (26)) < 1e-10);
    checked_free(&c);
}

static void test_overlapping_components(void **state) {
    (void)state;
    shape s = shape_cube(2), other = shape_cube(2);
    shape_append(&s, &other, (const double[3]){0.75, 0.5, 0.25}, 1);
    shape_free(&other);
    checked c = check_shape(&s);
    assert_true(c.check->findings[STARG_FINDING_SELF_INTERSECTION].count > 0);
    EXPECT(&c, STARG_FINDING_INWARD_COMPONENT, 1, STARG_ELEMENT_FACE, 48);
    assert_int_equal(c.check->cavities, 0);
    assert_true(c.check->usable);
    assert_false(c.check->embedded);
    assert_true(fabs(c.check->volume - (16)) < 1e-10);
    checked_free(&c);
}

/* Shells whose products of sizes overflow are still solids, and those whose volumes underflow are
 * told. */
static void test_scales(void **state) {
    (void)state;
    static const double scales[] = {1e-320, 1e-300, 1e-120, 1e-60, 1e60, 1e90, 4e99};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        shape s = shape_cavity();
        shape_place(&s, scales[i] / 4, 0);
        checked c = check_shape(&s);
        expect_only(&c, 0);
        assert_int_equal(c.check->usable, scales[i] > 1e-100);
        assert_int_equal(c.check->underflows, scales[i] < 1e-100);
        assert_int_equal(c.check->cavities, 1);
        checked_free(&c);
    }
}

/* ---- pairs ---- */

/* Two isolated triangles. */
static void expect_pair(const double *second, size_t crossings, size_t contacts) {
    double vertices[18] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
    memcpy(vertices + 9, second, 9 * sizeof(double));
    checked c = check_arrays(vertices, 6, (const uint32_t[6]){0, 1, 2, 3, 4, 5}, 2);
    EXPECT(&c, STARG_FINDING_SELF_INTERSECTION, crossings, STARG_ELEMENT_FACE, 0, 1);
    EXPECT(&c, STARG_FINDING_SELF_CONTACT, contacts, STARG_ELEMENT_FACE, 0, 1);
    checked_free(&c);
}

static void test_pairs(void **state) {
    (void)state;
    expect_pair((const double[9]){1, 1, -1, 1, 1, 1, 9, 9, 0}, 1, 0); /* passes through */
    expect_pair((const double[9]){1, 1, 0, 5, 1, 0, 1, 5, 0}, 1, 0);  /* coplanar, overlaps */
    expect_pair((const double[9]){4, 4, 0, 4, 0, 0, 0, 4, 0}, 0, 1);  /* coplanar, same edge */
    expect_pair((const double[9]){4, 4, 0, 5, 4, 0, 4, 5, 0}, 0, 0);  /* coplanar, apart */
    expect_pair((const double[9]){1, 1, 0, 1, 1, 3, 2, 2, 3}, 0, 1);  /* a corner on the face */
    expect_pair((const double[9]){1, 1, 0, 2, 1, 0, 2, 2, 3}, 0, 1);  /* an edge on the face: T */
    expect_pair((const double[9]){2, -1, 0, 2, 0, 0, 2, -1, 3}, 1,
                0); /* an edge through a corner */
    expect_pair((const double[9]){2, 0, 0, 1, -1, 1, 3, -1, 1}, 0, 1); /* a corner on an edge */
    expect_pair((const double[9]){4, 0, 0, 5, 0, 1, 5, 1, 1}, 0, 1);   /* corner to corner */
    expect_pair((const double[9]){1, 1, 0x1p-1074, 1, 1, 3, 2, 2, 3}, 0, 0);
    expect_pair((const double[9]){1, 1, -0x1p-1074, 1, 1, 3, 2, 2, 3}, 1, 0);
}

/* ---- random meshes against exact arithmetic ---- */

static int shared_first(const uint32_t *a, const uint32_t *b, uint32_t u[3], uint32_t v[3]) {
    int shared = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (a[i] == b[j]) {
                u[shared] = v[shared] = a[i];
                shared++;
            }
    for (int side = 0; side < 2; side++) {
        const uint32_t *from = side ? b : a;
        uint32_t *to = side ? v : u;
        int filled = shared;
        for (int i = 0; i < 3; i++) {
            bool common = false;
            for (int k = 0; k < shared; k++)
                common = common || to[k] == from[i];
            if (!common)
                to[filled++] = from[i];
        }
    }
    return shared;
}

static bool oracle_pair(const shape *s, size_t a, size_t b) {
    uint32_t u[3], v[3];
    int shared = shared_first(s->faces + 3 * a, s->faces + 3 * b, u, v);
    const double *p[3], *q[3];
    for (int k = 0; k < 3; k++) {
        p[k] = s->vertices + 3 * (size_t)u[k];
        q[k] = s->vertices + 3 * (size_t)v[k];
    }
    return shared == 3 || oracle_triangles_contact(p, q, shared);
}

/* Do the boxes of two faces meet? If not, the oracle is asked only occasionally. */
static bool boxes_meet(const shape *s, size_t a, size_t b) {
    for (int k = 0; k < 3; k++) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (size_t i = 0; i < 6; i++) {
            double x = s->vertices[3 * (size_t)s->faces[3 * (i < 3 ? a : b) + i % 3] + (size_t)k];
            low[i / 3] = fmin(low[i / 3], x);
            high[i / 3] = fmax(high[i / 3], x);
        }
        if (high[0] < low[1] || high[1] < low[0])
            return false;
    }
    return true;
}

/* For a zero-area face whose middle corner is shared, the check reports contact and the oracle does
 * not. Returns whether there is no such face, so that counts must be equal. */
static bool check_against_oracle(shape *s) {
    size_t meeting = 0;
    uint8_t *marked = calloc(s->face_count, 1);
    for (size_t a = 0; a < s->face_count; a++)
        for (size_t b = a + 1; b < s->face_count; b++)
            if (boxes_meet(s, a, b) && oracle_pair(s, a, b)) {
                meeting++;
                marked[a] = marked[b] = 1;
            }
    size_t faces = s->face_count;
    checked c = check_shape(s);
    size_t found = c.check->findings[STARG_FINDING_SELF_INTERSECTION].count +
                   c.check->findings[STARG_FINDING_SELF_CONTACT].count;
    bool all_have_area = c.check->findings[STARG_FINDING_DEGENERATE_FACE].count == 0;
    assert_true(found >= meeting);
    if (all_have_area)
        assert_int_equal(found, meeting);
    for (size_t f = 0; f < faces; f++)
        if (marked[f])
            assert_int_not_equal(c.check->face_marks[f], 0);
    free(marked);
    checked_free(&c);
    return all_have_area;
}

/* Moves vertices off the positions of earlier ones: contact in coincident vertices is contact for
 * the check, but not for the oracle, which knows positions only. */
static void part_equal(shape *s) {
    for (size_t i = 0; i < s->vertex_count; i++)
        for (size_t k = 0; k < i; k++)
            if (memcmp(s->vertices + 3 * i, s->vertices + 3 * k, 3 * sizeof(double)) == 0)
                s->vertices[3 * i + 2] += 0.25 + 0.001953125 * (double)i;
}

/* Positions on a coarse lattice, with contacts of every kind. */
static void test_random_lattice(void **state) {
    (void)state;
    size_t equal = 0;
    for (uint64_t round = 0; round < 24; round++) {
        starg_rng rng = starg_rng_make(5, 0, round);
        shape s = shape_cube(2);
        for (size_t i = 0; i < 3 * s.vertex_count; i++)
            if (starg_rng_below(&rng, 4 + round) == 0)
                s.vertices[i] += (double)starg_rng_below(&rng, 5) - 2;
        part_equal(&s);
        equal += check_against_oracle(&s);
    }
    assert_true(equal >= 5);
}

static void test_random_blobs(void **state) {
    (void)state;
    for (uint64_t round = 0; round < 4; round++) {
        starg_rng rng = starg_rng_make(5, 1, round);
        shape s = shape_blob(2, round);
        for (size_t i = 0; i < 3 * s.vertex_count; i++)
            s.vertices[i] += 0.5 * (starg_rng_unit(&rng) - 0.5) * (double)round;
        assert_true(check_against_oracle(&s));
    }
}

/* ---- memory and cancelling ---- */

/* ---- faces around vertices of many ---- */

enum { FANS = 3, SPOKES = 90, LOOSE = 60, HUB_FACES = FANS * SPOKES + LOOSE };

typedef struct visited {
    uint8_t times[HUB_FACES][HUB_FACES];
    size_t count;
} visited;

static bool note_visit(void *user, uint32_t a, uint32_t b) {
    visited *v = user;
    v->times[a < b ? a : b][a < b ? b : a]++;
    v->count++;
    return true;
}

/* Fans of triangles about three vertices, some flat, and loose triangles between them. */
static void make_hubs(starg_rng *rng, bool flat, double *vertices, uint32_t *faces) {
    for (size_t v = 0; v < FANS + 2 * (size_t)HUB_FACES; v++)
        for (size_t k = 0; k < 3; k++)
            vertices[3 * v + k] = flat && k == 2 ? 0 : (double)starg_rng_below(rng, 64);
    for (size_t v = FANS + 1; v < FANS + 2 * (size_t)HUB_FACES; v += 2) /* narrow triangles */
        for (size_t k = 0; k < 3; k++)
            vertices[3 * v + k] =
                vertices[3 * v + k - 3] + (flat && k == 2 ? 0 : (double)starg_rng_below(rng, 5));
    for (uint32_t f = 0; f < HUB_FACES; f++) {
        uint32_t own = FANS + 2 * f, other = FANS + 2 * (uint32_t)starg_rng_below(rng, HUB_FACES);
        faces[3 * f] = f < FANS * SPOKES ? f % FANS : other;
        faces[3 * f + 1] = own;
        faces[3 * f + 2] = starg_rng_below(rng, 4) == 0 ? other + 1 : own + 1;
    }
}

/* Every pair that meets elsewhere than in a common corner is visited, and none twice; most of the
 * others are not. */
static void test_hubs(void **state) {
    (void)state;
    static double vertices[3 * (FANS + 2 * HUB_FACES)];
    static uint32_t faces[3 * HUB_FACES];
    starg_context *context = test_context(1);
    for (uint64_t round = 0; round < test_rounds(6, 200); round++) {
        starg_rng rng = starg_rng_make(7, 1, round);
        starg_mesh *mesh;
        bvh *tree;
        visited *v = calloc(1, sizeof *v);
        assert_non_null(v);
        make_hubs(&rng, round % 2 == 1, vertices, faces);
        test_ok(context, starg_mesh_create(context, vertices, FANS + 2 * (size_t)HUB_FACES, faces,
                                           HUB_FACES, &mesh));
        test_ok(context, bvh_create(context, vertices, faces, HUB_FACES, &tree));
        test_ok(context, face_pairs_visit(context, mesh, tree, NULL, note_visit, v));
        for (uint32_t a = 0; a < HUB_FACES; a++)
            for (uint32_t b = a + 1; b < HUB_FACES; b++) {
                triangle_contact contact =
                    faces_contact(vertices, faces + 3 * (size_t)a, faces + 3 * (size_t)b);
                assert_true(v->times[a][b] <= 1);
                if (contact == TRIANGLES_TOUCH || contact == TRIANGLES_CROSS)
                    assert_int_equal(v->times[a][b], 1);
            }
        if (round % 2 == 0) /* in space most pairs of a fan are apart */
            assert_true(v->count < HUB_FACES * (HUB_FACES - 1) / 4);
        free(v);
        bvh_free(tree);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

static void test_cancel(void **state) {
    (void)state;
    starg_context_options options;
    starg_context_options_default(&options);
    options.progress = test_refuse;
    starg_context *context;
    starg_mesh *mesh;
    starg_check *check;
    assert_int_equal(starg_context_create(&options, &context), STARG_OK);
    test_ok(context, starg_mesh_create(context, TETRAHEDRON, 4, TETRAHEDRON_FACES, 4, &mesh));
    starg_context_cancel(context);
    assert_int_equal(starg_mesh_check(context, mesh, &check), STARG_ERROR_CANCELLED);
    assert_null(check);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void test_every_allocation_fails_once(void **state) {
    (void)state;
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(0, &left);
    starg_mesh *mesh;
    starg_check *check = NULL;
    test_ok(context, starg_mesh_create(context, TETRAHEDRON, 4, TETRAHEDRON_FACES, 4, &mesh));
    size_t failures = 0;
    starg_status status;
    do {
        left = failures;
        status = starg_mesh_check(context, mesh, &check);
        if (status != STARG_OK) {
            assert_int_equal(status, STARG_ERROR_MEMORY);
            assert_null(check);
            assert_int_equal(starg_context_live_blocks(context), 3);
            failures++;
        }
    } while (status != STARG_OK);
    assert_true(failures > 5);
    left = SIZE_MAX;
    starg_check_free(context, check);
    starg_mesh_free(mesh);
    test_context_free(context);
}

static void test_names(void **state) {
    (void)state;
    for (int kind = 0; kind < STARG_FINDING_KINDS; kind++)
        for (int other = 0; other < kind; other++)
            assert_string_not_equal(starg_finding_name((starg_finding_kind)kind),
                                    starg_finding_name((starg_finding_kind)other));
    assert_string_equal(starg_finding_name(STARG_FINDING_OPEN_EDGE), "open edges");
    assert_string_equal(starg_finding_name(STARG_FINDING_KINDS), "unknown findings");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tetrahedron),
        cmocka_unit_test(test_genus),
        cmocka_unit_test(test_no_faces),
        cmocka_unit_test(test_open_edges),
        cmocka_unit_test(test_nonmanifold_edge),
        cmocka_unit_test(test_nonmanifold_vertex),
        cmocka_unit_test(test_inconsistent_edges),
        cmocka_unit_test(test_repeated_corner),
        cmocka_unit_test(test_degenerate_face),
        cmocka_unit_test(test_duplicate_face),
        cmocka_unit_test(test_duplicate_and_isolated_vertices),
        cmocka_unit_test(test_inward),
        cmocka_unit_test(test_nested_shells),
        cmocka_unit_test(test_cavity),
        cmocka_unit_test(test_overlapping_components),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_pairs),
        cmocka_unit_test(test_random_lattice),
        cmocka_unit_test(test_random_blobs),
        cmocka_unit_test(test_hubs),
        cmocka_unit_test(test_cancel),
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
