/* SPDX-License-Identifier: Apache-2.0 */
/* Halfedge mesh under random collapses, flips and splits, compared with a list of oriented
 * triangles that implements each by its definition. */
#include "mesh/halfedges.h"

#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "models.h"

enum { MOST = 20000 };

typedef struct triangle_list {
    uint32_t corners[MOST][3];
    size_t count;
} triangle_list;

/* Rotates to start at the lowest corner. */
static void canonical(uint32_t t[3]) {
    while (t[0] > t[1] || t[0] > t[2]) {
        uint32_t first = t[0];
        t[0] = t[1];
        t[1] = t[2];
        t[2] = first;
    }
}

static int compare(const void *a, const void *b) {
    const uint32_t *s = a, *t = b;
    for (int k = 0; k < 3; k++)
        if (s[k] != t[k])
            return s[k] < t[k] ? -1 : 1;
    return 0;
}

static void list_add(triangle_list *list, uint32_t a, uint32_t b, uint32_t c) {
    assert_true(list->count < MOST);
    uint32_t *t = list->corners[list->count++];
    t[0] = a, t[1] = b, t[2] = c;
    canonical(t);
}

static void list_drop(triangle_list *list, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t t[3] = {a, b, c};
    canonical(t);
    for (size_t i = 0; i < list->count; i++)
        if (compare(list->corners[i], t) == 0) {
            memcpy(list->corners[i], list->corners[--list->count], sizeof t);
            return;
        }
    fail_msg("there is no face %u %u %u", a, b, c);
}

static void list_merge(triangle_list *list, uint32_t gone, uint32_t into) {
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        uint32_t t[3];
        for (int k = 0; k < 3; k++)
            t[k] = list->corners[i][k] == gone ? into : list->corners[i][k];
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
            continue;
        canonical(t);
        memcpy(list->corners[kept++], t, sizeof t);
    }
    list->count = kept;
}

static bool list_has_edge(const triangle_list *list, uint32_t v, uint32_t w) {
    for (size_t i = 0; i < list->count; i++)
        for (int k = 0; k < 3; k++)
            if (list->corners[i][k] == v && list->corners[i][(k + 1) % 3] == w)
                return true;
    return false;
}

/* Vertices joined to both; the link condition requires two, and no tetrahedron. */
static bool may_collapse(const triangle_list *list, uint32_t a, uint32_t b, size_t vertices) {
    size_t common = 0, degree = 0;
    for (uint32_t v = 0; v < vertices; v++) {
        bool at_a = list_has_edge(list, a, v), at_b = list_has_edge(list, b, v);
        common += at_a && at_b;
        degree += (size_t)at_a + at_b;
    }
    return common == 2 && degree > 6;
}

/* The living faces are those of the list; twins, rings and leaving halfedges are consistent. */
static void expect_same(const mesh_halfedges *m, const triangle_list *list) {
    static triangle_list found, sorted;
    static uint32_t degree[MOST];
    found.count = 0;
    memset(degree, 0, sizeof degree);
    for (uint32_t f = 0; f < m->corners.count / 3; f++) {
        if (!halfedges_face_lives(m, f))
            continue;
        const uint32_t *t = m->corners.data + 3 * (size_t)f;
        list_add(&found, t[0], t[1], t[2]);
        for (uint32_t h = 3 * f; h < 3 * f + 3; h++) {
            uint32_t twin = halfedges_twin(m, h);
            assert_int_equal(halfedges_twin(m, twin), h);
            assert_int_equal(halfedges_start(m, twin), halfedges_end(m, h));
            assert_int_equal(halfedges_end(m, twin), halfedges_start(m, h));
            assert_int_equal(halfedges_find(m, halfedges_start(m, h), halfedges_end(m, h)), h);
            degree[halfedges_start(m, h)]++;
        }
    }
    sorted = *list;
    qsort(found.corners, found.count, sizeof *found.corners, compare);
    qsort(sorted.corners, sorted.count, sizeof *sorted.corners, compare);
    assert_int_equal(found.count, sorted.count);
    assert_memory_equal(found.corners, sorted.corners, found.count * sizeof *found.corners);
    for (uint32_t v = 0; v < m->leaving.count; v++) {
        uint32_t ring[256], first = m->leaving.data[v];
        assert_int_equal(first == TOPOLOGY_NONE, degree[v] == 0);
        if (first == TOPOLOGY_NONE)
            continue;
        assert_int_equal(halfedges_start(m, first), v);
        assert_int_equal(halfedges_ring(m, v, ring, 256), degree[v]);
        assert_int_equal(halfedges_ring(m, v, ring, degree[v] - 1), 0);
    }
}

static bool try_collapse(mesh_halfedges *m, triangle_list *list, uint32_t h) {
    uint32_t a = halfedges_start(m, h), b = halfedges_end(m, h);
    uint32_t at_a[64], at_b[64];
    size_t count_a = halfedges_ring(m, a, at_a, 64), count_b = halfedges_ring(m, b, at_b, 64);
    bool may = may_collapse(list, a, b, m->leaving.count);
    if (count_a > 0 && count_b > 0 && count_a + count_b > 6)
        assert_int_equal(halfedges_common(m, at_a, count_a, at_b, count_b) == 2, may);
    if (!may)
        return false;
    halfedges_collapse(m, h);
    list_merge(list, b, a);
    return true;
}

static bool try_flip(mesh_halfedges *m, triangle_list *list, uint32_t h) {
    uint32_t u = halfedges_start(m, h), v = halfedges_end(m, h), w = halfedges_apex(m, h);
    uint32_t x = halfedges_apex(m, halfedges_twin(m, h));
    if (w == x || list_has_edge(list, w, x))
        return false;
    halfedges_flip(m, h);
    list_drop(list, u, v, w);
    list_drop(list, v, u, x);
    list_add(list, w, u, x);
    list_add(list, x, v, w);
    return true;
}

static void split_edge(mesh_halfedges *m, triangle_list *list, uint32_t h) {
    uint32_t u = halfedges_start(m, h), v = halfedges_end(m, h), w = halfedges_apex(m, h), p = 0;
    uint32_t x = halfedges_apex(m, halfedges_twin(m, h));
    assert_int_equal(halfedges_split_edge(m, h, &p), STARG_OK);
    list_drop(list, u, v, w);
    list_drop(list, v, u, x);
    list_add(list, u, p, w);
    list_add(list, p, v, w);
    list_add(list, v, p, x);
    list_add(list, p, u, x);
}

static void split_face(mesh_halfedges *m, triangle_list *list, uint32_t f) {
    uint32_t t[3], p = 0;
    memcpy(t, m->corners.data + 3 * (size_t)f, sizeof t);
    assert_int_equal(halfedges_split_face(m, f, &p), STARG_OK);
    list_drop(list, t[0], t[1], t[2]);
    for (int k = 0; k < 3; k++)
        list_add(list, t[k], t[(k + 1) % 3], p);
}

static uint32_t random_halfedge(const mesh_halfedges *m, starg_rng *rng) {
    uint32_t h;
    do
        h = (uint32_t)starg_rng_below(rng, m->corners.count);
    while (!halfedges_face_lives(m, h / 3));
    return h;
}

static mesh_halfedges begin(starg_context *context, const starg_mesh *mesh, triangle_list *list) {
    mesh_topology *topology = NULL;
    mesh_halfedges m;
    test_ok(context, topology_create(context, mesh, &topology));
    test_ok(context, halfedges_create(topology, mesh, "test", &m));
    topology_free(topology);
    list->count = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
        list_add(list, mesh->faces[3 * f], mesh->faces[3 * f + 1], mesh->faces[3 * f + 2]);
    return m;
}

/* A sphere-like figure and one with handles, as far down as collapses go, and up again. */
static void test_random(void **state) {
    (void)state;
    static triangle_list list, untouched;
    starg_context *context = test_context(1);
    for (int model = 0; model < 2; model++) {
        starg_mesh *mesh = test_sample_mesh(context, model ? "knot" : "cat", 500);
        mesh_halfedges m = begin(context, mesh, &list), copy;
        starg_rng rng = starg_rng_make(11, (uint64_t)model, 0);
        size_t done[4] = {0};
        for (int step = 0; step < 1500; step++) {
            uint32_t h = random_halfedge(&m, &rng);
            uint64_t dice = starg_rng_below(&rng, 10);
            if (dice < 6) {
                done[0] += try_collapse(&m, &list, h);
            } else if (dice < 8) {
                done[1] += try_flip(&m, &list, h);
            } else if (dice < 9) {
                split_edge(&m, &list, h);
                done[2]++;
            } else {
                split_face(&m, &list, h / 3);
                done[3]++;
            }
            halfedges_begin_face(&m, random_halfedge(&m, &rng));
            if (step % 50 == 0)
                expect_same(&m, &list);
        }
        expect_same(&m, &list);
        for (int k = 0; k < 4; k++)
            assert_true(done[k] > 50);
        test_ok(context, halfedges_copy(&m, &copy));
        untouched = list;
        for (int step = 0; step < 20; step++)
            try_flip(&m, &list, random_halfedge(&m, &rng));
        expect_same(&m, &list);
        expect_same(&copy, &untouched);
        halfedges_free(&m);
        halfedges_free(&copy);
        starg_mesh_free(mesh);
    }
    test_context_free(context);
}

/* The rest, numbered without gaps, is a closed mesh of the same genus. */
static void test_compact(void **state) {
    (void)state;
    static triangle_list list;
    starg_context *context = test_context(1);
    starg_mesh *mesh = test_sample_mesh(context, "knot", 500), *left = NULL;
    mesh_halfedges m = begin(context, mesh, &list);
    starg_rng rng = starg_rng_make(12, 0, 0);
    for (int step = 0; step < 1000; step++)
        try_collapse(&m, &list, random_halfedge(&m, &rng));
    uint32_t *faces = malloc(3 * list.count * sizeof *faces), number[MOST];
    double *points = calloc(3 * m.leaving.count, sizeof *points);
    assert_true(faces != NULL && points != NULL);
    size_t count = halfedges_compact(&m, number, faces);
    test_ok(context, starg_mesh_create(context, points, count, faces, list.count, &left));
    mesh_topology *topology = NULL;
    test_ok(context, topology_create(context, left, &topology));
    for (size_t h = 0; h < 3 * left->face_count; h++)
        assert_true(topology->twin[h] != TOPOLOGY_NONE);
    size_t before = mesh->vertex_count - mesh->face_count / 2; /* of Euler's number: V - F / 2 */
    assert_int_equal(count - left->face_count / 2, before);
    topology_free(topology);
    starg_mesh_free(left);
    free(points);
    free(faces);
    halfedges_free(&m);
    starg_mesh_free(mesh);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_compact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
