/* SPDX-License-Identifier: Apache-2.0 */
/* The overlay of two triangulations: checked by the verifier, which shares no code with it, and by
 * random points, of which each lies in one triangle. Lattices have vertices that coincide, lie on
 * edges, and edges on one another. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/rng.h"
#include "mesh/mesh.h"
#include "models.h"
#include "starguard/morph.h"
#include "starguard/verify.h"

/* ---- octahedra ---- */

typedef struct lattice {
    double vertices[3 * 1000];
    uint32_t faces[3 * 2000];
    size_t vertex_count, face_count;
} lattice;

static uint32_t vertex_of(lattice *l, const int p[3]) {
    for (uint32_t v = 0; v < l->vertex_count; v++)
        if (l->vertices[3 * v] == p[0] && l->vertices[3 * v + 1] == p[1] &&
            l->vertices[3 * v + 2] == p[2])
            return v;
    for (size_t k = 0; k < 3; k++)
        l->vertices[3 * l->vertex_count + k] = p[k];
    return (uint32_t)l->vertex_count++;
}

/* Counter-clockwise from outside. */
static void add_face(lattice *l, int p[3][3]) {
    int det = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
              p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
              p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    assert_true(det != 0);
    uint32_t *face = l->faces + 3 * l->face_count++;
    face[0] = vertex_of(l, p[0]);
    face[det > 0 ? 1 : 2] = vertex_of(l, p[1]);
    face[det > 0 ? 2 : 1] = vertex_of(l, p[2]);
}

/* An octahedron with n^2 triangles a side, with coordinates of sum `size` (a multiple of n). */
static lattice *octahedron(int n, int size) {
    lattice *l = calloc(1, sizeof *l);
    assert_non_null(l);
    int step = size / n;
    for (int side = 0; side < 8; side++) {
        const int sign[3] = {side & 1 ? -step : step, side & 2 ? -step : step,
                             side & 4 ? -step : step};
        for (int i = 0; i < n; i++)
            for (int j = 0; i + j < n; j++)
                for (int up = 0; up < 2 && i + j + up < n; up++) {
                    const int offsets[2][3][2] = {{{0, 0}, {1, 0}, {0, 1}},
                                                  {{1, 0}, {0, 1}, {1, 1}}};
                    int p[3][3];
                    for (int k = 0; k < 3; k++) {
                        int x = i + offsets[up][k][0], y = j + offsets[up][k][1];
                        const int weights[3] = {x, y, n - x - y};
                        for (int c = 0; c < 3; c++)
                            p[k][c] = sign[c] * weights[c];
                    }
                    add_face(l, p);
                }
    }
    return l;
}

/* Flips the diagonals of some pairs of faces at random, where both stay positive. */
static void flip_some(lattice *l, uint64_t seed) {
    starg_rng rng = starg_rng_make(seed, 1, 0);
    for (int tries = 0; tries < 200; tries++) {
        uint32_t *f = l->faces + 3 * starg_rng_below(&rng, l->face_count);
        uint32_t *g = l->faces + 3 * starg_rng_below(&rng, l->face_count);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                if (f[i] == g[(j + 1) % 3] && f[(i + 1) % 3] == g[j]) {
                    const uint32_t a = f[i], b = f[(i + 1) % 3], c = f[(i + 2) % 3],
                                   d = g[(j + 2) % 3];
                    const double *p[4] = {l->vertices + 3 * a, l->vertices + 3 * b,
                                          l->vertices + 3 * c, l->vertices + 3 * d};
                    double first = 0, second = 0;
                    for (int k = 0; k < 3; k++) {
                        int m = (k + 1) % 3, n = (k + 2) % 3;
                        double cross = p[2][m] * p[3][n] - p[2][n] * p[3][m];
                        first -= p[0][k] * cross;  /* det(a, d, c) */
                        second += p[1][k] * cross; /* det(b, c, d) */
                    }
                    if (first <= 0 || second <= 0)
                        continue;
                    const uint32_t one[3] = {a, d, c}, two[3] = {b, c, d};
                    memcpy(f, one, sizeof one);
                    memcpy(g, two, sizeof two);
                    i = j = 3;
                }
    }
}

/* ---- maps of given directions ---- */

static starg_mesh *mesh_of(starg_context *context, const lattice *l) {
    starg_mesh *mesh = NULL;
    test_ok(context, starg_mesh_create(context, l->vertices, l->vertex_count, l->faces,
                                       l->face_count, &mesh));
    return mesh;
}

static double *copy_vertices(starg_context *context, const starg_mesh *mesh) {
    size_t count = 3 * starg_mesh_vertex_count(mesh);
    double *copy = starg_allocate(context, count, sizeof *copy);
    assert_non_null(copy);
    memcpy(copy, starg_mesh_vertices(mesh), count * sizeof *copy);
    return copy;
}

/* A map by directions that are the vertices themselves; the overlay says where vertices go. */
static starg_map *map_of(starg_context *context, const starg_mesh *a, const starg_mesh *b) {
    starg_map *map = starg_allocate_zero(context, 1, sizeof *map);
    assert_non_null(map);
    map->kind = STARG_MAP_SPHERE;
    map->vertex_count = map->direction_count = starg_mesh_vertex_count(a);
    map->target_vertices = map->target_direction_count = starg_mesh_vertex_count(b);
    map->target_faces = starg_mesh_face_count(b);
    map->faces = starg_allocate_zero(context, map->vertex_count, sizeof *map->faces);
    map->coordinates = starg_allocate_zero(context, 3 * map->vertex_count, sizeof(double));
    map->directions = copy_vertices(context, a);
    map->target_directions = copy_vertices(context, b);
    return map;
}

static starg_verdict *verdict_of(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                 const starg_map *map) {
    char *text = NULL;
    size_t size = 0;
    starg_map_file *file = NULL;
    starg_verdict *verdict = NULL;
    test_ok(context, starg_map_write_memory(context, map, &text, &size));
    test_ok(context, starg_map_file_read_memory(context, text, size, "map", &file));
    test_ok(context, starg_verify_map(context, a, b, file, &verdict));
    starg_map_file_free(file);
    starg_text_free(context, text);
    return verdict;
}

static bool passes(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                   const starg_map *map) {
    starg_verdict *verdict = verdict_of(context, a, b, map);
    bool passed = verdict->passed;
    starg_verdict_free(context, verdict);
    return passed;
}

/* ---- random points ---- */

/* Weights of an overlay vertex in a face of the mesh; false if it is not in it. */
static bool weights_in(const starg_mesh *mesh, const uint32_t *faces, const double *coordinates,
                       uint32_t vertex, size_t face, double w[3]) {
    const uint32_t *own = mesh->faces + 3 * (size_t)faces[vertex], *other = mesh->faces + 3 * face;
    const double *held = coordinates + 3 * (size_t)vertex;
    int missing = (held[0] != 0) + (held[1] != 0) + (held[2] != 0);
    for (int k = 0; k < 3; k++) {
        w[k] = 0;
        for (int j = 0; j < 3; j++)
            if (other[k] == own[j])
                w[k] = held[j];
        missing -= w[k] != 0;
    }
    return missing == 0;
}

/* Each random point of each face is in one triangle, and the areas of triangles sum to the
 * face's. */
static void assert_filled(const starg_mesh *mesh, const starg_overlay *o, int end) {
    const uint32_t *faces = end == 0 ? o->own_faces : o->target_faces;
    const double *coordinates = end == 0 ? o->own_coordinates : o->target_coordinates;
    starg_rng rng = starg_rng_make(7, 2, (uint64_t)end);
    for (size_t f = 0; f < mesh->face_count; f++) {
        double x[3], area = 0;
        size_t count = 0;
        x[0] = starg_rng_unit(&rng);
        x[1] = (1 - x[0]) * starg_rng_unit(&rng);
        x[2] = 1 - x[0] - x[1];
        for (size_t t = 0; t < o->face_count; t++) {
            double w[3][3], part[3], all = 0;
            bool in = true;
            for (int k = 0; k < 3 && in; k++)
                in = weights_in(mesh, faces, coordinates, o->faces[3 * t + (size_t)k], f, w[k]);
            if (!in)
                continue;
            for (int k = 0; k < 3; k++) {
                const double *p = w[(k + 1) % 3], *q = w[(k + 2) % 3];
                part[k] = x[0] * (p[1] * q[2] - p[2] * q[1]) + x[1] * (p[2] * q[0] - p[0] * q[2]) +
                          x[2] * (p[0] * q[1] - p[1] * q[0]);
                all += part[k];
            }
            assert_true(all > -1e-15); /* exactly: by the verifier */
            area += all;
            count += part[0] > 0 && part[1] > 0 && part[2] > 0;
        }
        assert_int_equal(count, 1);
        assert_true(fabs(area - 1) < 1e-9);
    }
}

static void check_pair(starg_context *context, const starg_mesh *a, const starg_mesh *b) {
    starg_map *map = map_of(context, a, b);
    test_ok(context, starg_map_overlay(context, a, b, map));
    assert_true(passes(context, a, b, map));
    assert_int_equal(2 * map->overlay.vertex_count, map->overlay.face_count + 4);
    assert_filled(a, &map->overlay, 0);
    assert_filled(b, &map->overlay, 1);
    starg_map_free(context, map);
}

static void test_lattices(void **state) {
    (void)state;
    static const int sizes[][2] = {{1, 1}, {1, 3}, {2, 3}, {2, 4}, {3, 3}, {3, 4}, {6, 4}};
    starg_context *context = test_context(1);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint64_t seed = 0; seed < 3; seed++) {
            lattice *first = octahedron(sizes[i][0], 12), *second = octahedron(sizes[i][1], 12);
            flip_some(first, 10 * i + seed);
            if (seed > 0)
                flip_some(second, 1000 + 10 * i + seed);
            starg_mesh *a = mesh_of(context, first), *b = mesh_of(context, second);
            check_pair(context, a, b);
            starg_mesh_free(a);
            starg_mesh_free(b);
            free(first);
            free(second);
        }
    test_context_free(context);
}

/* Vertices moved a little: crossings near vertices, and triangles as thin as rounding. */
static void test_near_lattices(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int exponent = -4; exponent >= -52; exponent -= 12) {
        lattice *first = octahedron(4, 12), *second = octahedron(3, 12);
        starg_rng rng = starg_rng_make((uint64_t)-exponent, 3, 0);
        for (size_t i = 0; i < 3 * first->vertex_count; i++)
            first->vertices[i] += ldexp(starg_rng_unit(&rng) - 0.5, exponent);
        starg_mesh *a = mesh_of(context, first), *b = mesh_of(context, second);
        check_pair(context, a, b);
        starg_mesh_free(a);
        starg_mesh_free(b);
        free(first);
        free(second);
    }
    test_context_free(context);
}

/* A model turned inside out has the same overlay. */
static void test_inward(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    lattice *first = octahedron(2, 12), *second = octahedron(3, 12);
    for (size_t f = 0; f < first->face_count; f++) {
        uint32_t kept = first->faces[3 * f];
        first->faces[3 * f] = first->faces[3 * f + 1];
        first->faces[3 * f + 1] = kept;
    }
    starg_mesh *a = mesh_of(context, first), *b = mesh_of(context, second);
    starg_map *map = map_of(context, a, b);
    test_ok(context, starg_map_overlay(context, a, b, map));
    assert_true(passes(context, a, b, map));
    starg_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    free(first);
    free(second);
    test_context_free(context);
}

/* Whatever is spoilt, the verifier finds it. */
static void test_forged(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    lattice *first = octahedron(2, 12), *second = octahedron(3, 12);
    starg_mesh *a = mesh_of(context, first), *b = mesh_of(context, second);
    for (int what = 0; what < 7; what++) {
        starg_map *map = map_of(context, a, b);
        test_ok(context, starg_map_overlay(context, a, b, map));
        starg_overlay *o = &map->overlay;
        if (what == 0)
            o->face_count--;
        if (what == 1)
            o->faces[0] = (o->faces[0] + 1) % (uint32_t)o->vertex_count;
        if (what == 2)
            o->own_coordinates[3] = 0.25;
        if (what == 3)
            map->directions[0] = -map->directions[0] - 1;
        if (what == 4)
            map->coordinates[0] = map->coordinates[0] > 0.5 ? 0.25 : 0.75;
        if (what == 5)
            map->faces[0] = (map->faces[0] + 7) % (uint32_t)b->face_count;
        if (what == 6)
            map->mean_angle_distortion += 1e-3;
        assert_false(passes(context, a, b, map));
        starg_map_free(context, map);
    }
    starg_mesh_free(a);
    starg_mesh_free(b);
    free(first);
    free(second);
    test_context_free(context);
}

/* Directions that fold are refused, with the face. */
static void test_folds(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    lattice *first = octahedron(2, 12);
    starg_mesh *a = mesh_of(context, first);
    starg_map *map = map_of(context, a, a);
    for (size_t k = 0; k < 3; k++)
        map->target_directions[k] = -map->target_directions[k];
    map->faces[0] = 5; /* not the identity */
    assert_int_equal(starg_map_overlay(context, a, a, map), STARG_ERROR_MESH);
    assert_non_null(strstr(starg_context_error(context)->message, "folds"));
    assert_int_equal(map->overlay.face_count, 0);
    starg_map_free(context, map);
    starg_mesh_free(a);
    free(first);
    test_context_free(context);
}

/* The same vertices, some edges flipped wherever they are: both share directions. */
static void test_flipped_edges(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "cat", 700), *b = NULL;
    size_t count = 3 * a->face_count, flipped = 0;
    uint32_t *faces = malloc(count * sizeof *faces);
    assert_non_null(faces);
    memcpy(faces, a->faces, count * sizeof *faces);
    for (size_t f = 5; f < a->face_count && flipped < 20; f += 61)
        for (size_t g = 0; g < a->face_count; g++)
            for (size_t j = 0; j < 3; j++) {
                uint32_t *s = faces + 3 * f, *t = faces + 3 * g;
                if (s[0] != t[(j + 1) % 3] || s[1] != t[j])
                    continue;
                const uint32_t p = s[0], q = s[1], r = s[2], u = t[(j + 2) % 3];
                const uint32_t one[3] = {p, u, r}, two[3] = {q, r, u};
                memcpy(s, one, sizeof one);
                memcpy(t, two, sizeof two);
                flipped++;
                g = a->face_count - 1;
                break;
            }
    assert_true(flipped > 10);
    test_ok(context,
            starg_mesh_create(context, a->vertices, a->vertex_count, faces, a->face_count, &b));
    starg_map *map = NULL;
    test_ok(context, starg_map_create(context, a, b, NULL, &map));
    assert_int_equal(map->kind, STARG_MAP_SAME);
    test_ok(context, starg_map_overlay(context, a, b, map));
    assert_int_equal(map->overlay.vertex_count, a->vertex_count + flipped);
    assert_true(passes(context, a, b, map));
    starg_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    free(faces);
    test_context_free(context);
}

/* Two samples by way of the sphere, with landmarks; then their end frames. */
static void test_samples(void **state) {
    (void)state;
    static const uint32_t pairs[] = {10, 20, 300, 210, 155, 423};
    const starg_map_options options = {.landmarks = pairs, .landmark_count = 3};
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "sphere", 700),
               *b = test_sample_mesh(context, "star", 600);
    starg_map *map = NULL;
    test_ok(context, starg_map_create(context, a, b, &options, &map));
    assert_true(passes(context, a, b, map));
    test_ok(context, starg_map_overlay(context, a, b, map));
    assert_true(passes(context, a, b, map));
    assert_filled(a, &map->overlay, 0);
    assert_filled(b, &map->overlay, 1);
    starg_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lattices),      cmocka_unit_test(test_near_lattices),
        cmocka_unit_test(test_inward),        cmocka_unit_test(test_forged),
        cmocka_unit_test(test_folds),         cmocka_unit_test(test_samples),
        cmocka_unit_test(test_flipped_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
