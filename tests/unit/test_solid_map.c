/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between solids: checks the guarantees on the results alone, in rationals; that the verifier
 * refutes maps that are a little wrong; files; points and fields. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "exact_oracle.h"
#include "models.h"
#include "starguard/check.h"
#include "starguard/solidmap.h"
#include "starguard/tetra.h"
#include "tetrahedra.h"

enum { VERTICES = 500 };

/* Few steps of descent. */
static const starg_solid_map_options QUICK = {.steps = 30, .density = 1};

static bool has_tetgen(void) {
    bool found = system("command -v tetgen >/dev/null 2>&1") == 0;
    if (!found)
        printf("skipped: the program tetgen is not installed\n");
    return found;
}

/* ---- oracles ---- */

static void check_positive(const starg_solid_map *map, const double *places) {
    for (size_t t = 0; t < map->count; t++) {
        const double *c[4];
        for (size_t k = 0; k < 4; k++)
            c[k] = places + 3 * (size_t)map->tetrahedra[4 * t + k];
        if (oracle_orient3d(c[0], c[1], c[2], c[3]) != -1)
            fail_msg("tetrahedron %zu is not positive", t);
    }
}

/* The boundary has the given positions, in order, and is subdivided at most. */
static void check_boundary(starg_context *context, const starg_solid_map *map, const double *places,
                           const starg_mesh *a, const double *positions) {
    starg_tetmesh *mesh;
    starg_mesh *surface;
    test_ok(context, starg_tetmesh_create(context, places, map->vertex_count, map->tetrahedra,
                                          map->count, NULL, &mesh));
    assert_int_equal(starg_tetmesh_turned(mesh), 0);
    test_ok(context, starg_tetmesh_surface(context, mesh, &surface, NULL));
    assert_subdivides(surface, a, positions);
    starg_mesh_free(surface);
    starg_tetmesh_free(mesh);
}

/* A guard sees every face of its piece from inside: no sign of a boundary face is wrong. */
static void check_pieces(const starg_solid_map *map, const double *places, const double *guards) {
    static const int OPPOSITE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (size_t t = 0; t < map->count; t += 9) { /* all take long */
        assert_in_range(map->labels[t], 0, map->piece_count - 1);
        for (size_t u = 0; u < 4; u++) {
            const double *c[3];
            for (int k = 0; k < 3; k++)
                c[k] = places + 3 * (size_t)map->tetrahedra[4 * t + (size_t)OPPOSITE[u][k]];
            const double *guard = guards + 3 * (size_t)map->labels[t];
            if (oracle_orient3d(c[0], c[1], c[2], guard) == 1)
                continue; /* else another tetrahedron of the piece must be behind the face */
            bool found = false;
            for (size_t s = 0; s < map->count && !found; s++) {
                int shared = 0;
                for (int k = 0; k < 3; k++)
                    for (size_t j = 0; j < 4; j++)
                        shared += map->tetrahedra[4 * s + j] ==
                                  map->tetrahedra[4 * t + (size_t)OPPOSITE[u][k]];
                found = s != t && shared == 3 && map->labels[s] == map->labels[t];
            }
            assert_true(found);
        }
    }
}

static bool is_verified(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                        const starg_solid_map *map, bool told) {
    starg_verdict *verdict;
    test_ok(context, starg_verify_solid_map(context, a, b, map, &verdict));
    bool passed = verdict->passed;
    for (size_t i = 0; told && i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            print_error("%s\n", verdict->claims[i].text);
    starg_verdict_free(context, verdict);
    return passed;
}

static starg_mesh *moved(starg_context *context, const starg_mesh *a, const double *positions) {
    starg_mesh *mesh;
    test_ok(context, starg_mesh_create(context, positions, starg_mesh_vertex_count(a),
                                       starg_mesh_faces(a), starg_mesh_face_count(a), &mesh));
    return mesh;
}

static void check(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                  const starg_solid_map *map) {
    check_positive(map, map->vertices);
    check_positive(map, map->images);
    check_boundary(context, map, map->vertices, a, starg_mesh_vertices(a));
    check_boundary(context, map, map->images, a, starg_mesh_vertices(b));
    check_pieces(map, map->vertices, map->guards);
    check_pieces(map, map->images, map->guard_images);
    assert_true(map->mean >= 1 && map->mean <= map->worst);
    assert_true(is_verified(context, a, b, map, true));
}

/* ---- maps ---- */

/* Two ends and the map between them, made once for tests that need any map. */
static struct {
    starg_context *context;
    starg_mesh *a, *b;
    starg_solid_map *map;
} cats;

/* A's vertices, turned about a line along x by an angle that grows with x; the caller's. */
static double *twist(const starg_mesh *a, double turn, double middle, double stretch, double size) {
    size_t count = 3 * starg_mesh_vertex_count(a);
    double *images = malloc(count * sizeof *images);
    assert_non_null(images);
    for (size_t v = 0; v < count; v += 3) {
        const double *p = starg_mesh_vertices(a) + v;
        double angle = turn * p[0], y = p[1] - middle;
        images[v] = size * (stretch * p[0]);
        images[v + 1] = size * (cos(angle) * y - sin(angle) * p[2]);
        images[v + 2] = size * (sin(angle) * y + cos(angle) * p[2]);
    }
    return images;
}

/* Of 204 vertices. */
static starg_mesh *beam(starg_context *context) {
    char cells[15 * 3 * 3];
    memset(cells, '#', sizeof cells);
    shape s = shape_cells(cells, 15, 3, 3);
    starg_mesh *mesh = test_mesh_of(context, &s);
    shape_free(&s);
    return mesh;
}

/* Two poses of a cat; or, in less time, a beam and the same twisted by half a turn. */
static void need_cats(void) {
    if (cats.map != NULL)
        return;
    cats.context = test_context(1);
    if (test_rounds(0, 1) == 1) {
        cats.a = test_pose(cats.context, "cat", 0, VERTICES);
        cats.b = test_pose(cats.context, "cat", 1, VERTICES);
    } else {
        cats.a = beam(cats.context);
        double *images = twist(cats.a, 0.2, 1.5, 1, 1);
        cats.b = moved(cats.context, cats.a, images);
        free(images);
    }
    test_ok(cats.context, starg_solid_map_create(cats.context, cats.a, starg_mesh_vertices(cats.b),
                                                 &QUICK, &cats.map));
    assert_true(cats.map->piece_count > 1);
}

static int free_cats(void **state) {
    (void)state;
    if (cats.map == NULL)
        return 0;
    starg_solid_map_free(cats.context, cats.map);
    starg_mesh_free(cats.a);
    starg_mesh_free(cats.b);
    test_context_free(cats.context);
    return 0;
}

/* The same with three threads. */
static void test_poses(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    need_cats();
    starg_context *many = test_context(3);
    const starg_solid_map *map = cats.map;
    starg_solid_map *same;
    test_ok(many, starg_solid_map_create(many, cats.a, starg_mesh_vertices(cats.b), &QUICK, &same));
    check(cats.context, cats.a, cats.b, map);
    assert_int_equal(map->count, same->count);
    assert_memory_equal(map->images, same->images, 3 * map->vertex_count * sizeof *map->images);
    assert_memory_equal(map->labels, same->labels, map->count * sizeof *map->labels);
    starg_solid_map_free(many, same);
    test_context_free(many);
}

/* A bent ring needs few pieces. */
static void test_few_pieces(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "torus", 0, VERTICES),
               *b = test_pose(context, "torus", 1, VERTICES);
    starg_solid_map *map;
    test_ok(context, starg_solid_map_create(context, a, starg_mesh_vertices(b), &QUICK, &map));
    print_message("%zu pieces\n", map->piece_count);
    assert_true(map->piece_count <= 8);
    starg_solid_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

static void check_twisted(const char *sample, double turn, double middle, double stretch,
                          double size) {
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, sample, VERTICES);
    double *images = twist(a, turn, middle, stretch, size);
    starg_mesh *b = moved(context, a, images);
    starg_solid_map *map;
    test_ok(context, starg_solid_map_create(context, a, images, &QUICK, &map));
    check(context, a, b, map);
    starg_solid_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    free(images);
    test_context_free(context);
}

/* Genus 6, twisted. */
static void test_handles(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    check_twisted("plate", 0.6, 0, 1.3, 1);
}

/* Twisted, and much smaller: the way there ends too soon, and what is inside has to go along. */
static void test_small_end(void **state) {
    (void)state;
    if (test_rounds(0, 1) == 0 || !has_tetgen())
        skip();
    check_twisted("dog", 6.2, 0.44, 1, 0.02);
}

/* Steps of descent lower the mean distortion. */
static void test_descent(void **state) {
    (void)state;
    if (test_rounds(0, 1) == 0 || !has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "dog", 0, VERTICES),
               *b = test_pose(context, "dog", 2, VERTICES);
    double means[2];
    for (size_t i = 0; i < 2; i++) {
        starg_solid_map_options options;
        starg_solid_map *map;
        starg_solid_map_options_default(&options);
        options.steps = 60 * i;
        test_ok(context,
                starg_solid_map_create(context, a, starg_mesh_vertices(b), &options, &map));
        check(context, a, b, map);
        means[i] = map->mean;
        starg_solid_map_free(context, map);
    }
    assert_true(means[1] < means[0]);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* A dog becomes a ball, and a ball a cube; in less time a beam and a ball of fewer faces. */
static starg_mesh *to_be_shaped(starg_context *context, int goal) {
    if (test_rounds(0, 1) == 1)
        return test_sample_mesh(context, goal == STARG_SOLID_BALL ? "dog" : "sphere", VERTICES);
    if (goal == STARG_SOLID_BALL)
        return beam(context);
    shape s = shape_blob(3, 2);
    starg_mesh *mesh = test_mesh_of(context, &s);
    shape_free(&s);
    return mesh;
}

static void test_shapes(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a, *b;
    for (int goal = 0; goal < 2; goal++) {
        starg_solid_map *map;
        a = to_be_shaped(context, goal);
        test_ok(context, starg_solid_map_to(context, a, (starg_solid_shape)goal, &QUICK, &map));
        for (size_t v = 0; v < starg_mesh_vertex_count(a); v++) {
            const double *p = map->images + 3 * v;
            double ball = hypot(hypot(p[0], p[1]), p[2]);
            double cube = fmax(fmax(fabs(p[0]), fabs(p[1])), fabs(p[2]));
            assert_true(goal == STARG_SOLID_BALL ? fabs(ball - 1) < 1e-12 : cube == 1);
        }
        b = moved(context, a, map->images);
        check(context, a, b, map);
        assert_true(is_verified(context, a, NULL, map, true));
        starg_mesh_free(a);
        starg_mesh_free(b);
        starg_solid_map_free(context, map);
    }
    a = test_sample_mesh(context, "torus", VERTICES);
    starg_solid_map *none;
    assert_int_equal(starg_solid_map_to(context, a, STARG_SOLID_BALL, NULL, &none),
                     STARG_ERROR_MESH);
    assert_null(none);
    starg_mesh_free(a);
    test_context_free(context);
}

/* ---- overlays ---- */

static void normal_of(const double *places, uint32_t a, uint32_t b, uint32_t c, double out[3]) {
    const double *p = places + 3 * (size_t)a, *q = places + 3 * (size_t)b,
                 *r = places + 3 * (size_t)c;
    double u[3], v[3], length = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = q[k] - p[k];
        v[k] = r[k] - p[k];
    }
    for (int k = 0; k < 3; k++) {
        out[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        length += out[k] * out[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] /= sqrt(length);
}

static double cosine(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The corner of an edge's face that is not on it; face_count: there is none. */
static size_t face_at(const uint32_t *faces, size_t count, uint32_t p, uint32_t q,
                      uint32_t *opposite) {
    for (size_t i = 0; i < 3 * count; i++)
        if (faces[i] == p && faces[i / 3 * 3 + (i + 1) % 3] == q) {
            *opposite = faces[i / 3 * 3 + (i + 2) % 3];
            return i / 3;
        }
    return count;
}

/* Flips so many edges, where there is room for it and the surface is nearly flat. */
static starg_mesh *flipped(starg_context *context, const starg_mesh *b, size_t flips) {
    size_t count = starg_mesh_face_count(b);
    const double *places = starg_mesh_vertices(b);
    uint32_t *faces = malloc(3 * count * sizeof *faces);
    uint8_t *used = calloc(count, 1);
    starg_mesh *out;
    assert_true(faces != NULL && used != NULL);
    memcpy(faces, starg_mesh_faces(b), 3 * count * sizeof *faces);
    for (size_t i = 0; i < 3 * count && flips > 0; i++) {
        size_t f = i / 3, k = i % 3;
        uint32_t p = faces[3 * f + k], q = faces[3 * f + (k + 1) % 3], s, none;
        uint32_t r = faces[3 * f + (k + 2) % 3];
        size_t g = face_at(faces, count, q, p, &s);
        double n[4][3];
        if (used[f] || used[g] || face_at(faces, count, r, s, &none) < count ||
            face_at(faces, count, s, r, &none) < count)
            continue;
        normal_of(places, p, q, r, n[0]);
        normal_of(places, q, p, s, n[1]);
        normal_of(places, p, s, r, n[2]);
        normal_of(places, s, q, r, n[3]);
        if (!(cosine(n[0], n[1]) > 0.97 && cosine(n[0], n[2]) > 0.97 && cosine(n[0], n[3]) > 0.97))
            continue;
        const uint32_t fresh[6] = {p, s, r, s, q, r};
        memcpy(faces + 3 * f, fresh, 3 * sizeof *faces);
        memcpy(faces + 3 * g, fresh + 3, 3 * sizeof *faces);
        used[f] = used[g] = 1;
        flips--;
    }
    assert_int_equal(flips, 0);
    test_ok(context,
            starg_mesh_create(context, places, starg_mesh_vertex_count(b), faces, count, &out));
    free(faces);
    free(used);
    return out;
}

/* Every vertex of the mesh is among the first places. */
static void check_kept(const starg_mesh *mesh, const double *places, size_t count) {
    for (size_t v = 0; v < starg_mesh_vertex_count(mesh); v++) {
        bool found = false;
        for (size_t i = 0; i < count && !found; i++)
            found =
                memcmp(places + 3 * i, starg_mesh_vertices(mesh) + 3 * v, 3 * sizeof *places) == 0;
        if (!found)
            fail_msg("vertex %zu is not in the map", v);
    }
}

/* The same surface, facing inward. */
static starg_mesh *turned(starg_context *context, const starg_mesh *a) {
    size_t count = starg_mesh_face_count(a);
    uint32_t *faces = malloc(3 * count * sizeof *faces);
    starg_mesh *out;
    assert_non_null(faces);
    for (size_t i = 0; i < 3 * count; i++)
        faces[i] = starg_mesh_faces(a)[i / 3 * 3 + 2 - i % 3];
    test_ok(context, starg_mesh_create(context, starg_mesh_vertices(a), starg_mesh_vertex_count(a),
                                       faces, count, &out));
    free(faces);
    return out;
}

static void check_overlay(const starg_mesh *a, const starg_mesh *b) {
    starg_context *one = test_context(1), *many = test_context(3);
    starg_map *surfaces;
    starg_solid_map *map, *same;
    test_ok(one, starg_map_create(one, a, b, NULL, &surfaces));
    assert_int_equal(starg_solid_map_overlay(one, a, b, surfaces, &QUICK, &map),
                     STARG_ERROR_ARGUMENT);
    assert_null(map);
    test_ok(one, starg_map_overlay(one, a, b, surfaces));
    test_ok(one, starg_solid_map_overlay(one, a, b, surfaces, &QUICK, &map));
    test_ok(many, starg_solid_map_overlay(many, a, b, surfaces, &QUICK, &same));
    check_positive(map, map->vertices);
    check_positive(map, map->images);
    check_pieces(map, map->vertices, map->guards);
    check_pieces(map, map->images, map->guard_images);
    check_kept(a, map->vertices, map->vertex_count);
    check_kept(b, map->images, map->vertex_count);
    assert_true(is_verified(one, a, b, map, true));
    assert_int_equal(map->count, same->count);
    assert_memory_equal(map->images, same->images, 3 * map->vertex_count * sizeof *map->images);
    starg_solid_map_free(one, map);
    starg_solid_map_free(many, same);
    starg_map_free(one, surfaces);
    test_context_free(one);
    test_context_free(many);
}

/* A pose with other edges here and there: the map ends at B, not at B in A's faces. */
static void test_overlay(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    need_cats();
    starg_mesh *b = flipped(cats.context, cats.b, 12);
    check_overlay(cats.a, b);
    assert_false(is_verified(cats.context, cats.a, b, cats.map, false)); /* without it */
    starg_mesh_free(b);
}

/* Balls with other faces: edges have many points. One faces inward. In less time: bent, with fewer
 * faces. */
static void test_overlay_of_balls(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a, *b, *inward;
    if (test_rounds(0, 1) == 1) {
        a = test_sample_mesh(context, "sphere", VERTICES);
        b = test_sample_mesh(context, "sphere", 3 * VERTICES / 2);
    } else {
        shape coarse = shape_blob(2, 1), fine = shape_blob(3, 2);
        a = test_mesh_of(context, &coarse);
        b = test_mesh_of(context, &fine);
        shape_free(&coarse);
        shape_free(&fine);
    }
    inward = turned(context, a);
    check_overlay(a, b);
    check_overlay(inward, b);
    starg_mesh_free(a);
    starg_mesh_free(b);
    starg_mesh_free(inward);
    test_context_free(context);
}

/* ---- surfaces that fold ---- */

/* The vertex farthest along x, moved over a neighbour and beyond. */
static void fold(const starg_mesh *a, double far, double *images) {
    const uint32_t *faces = starg_mesh_faces(a);
    const double *v = starg_mesh_vertices(a);
    size_t count = starg_mesh_vertex_count(a), most = 0, other = 0;
    memcpy(images, v, 3 * count * sizeof *images);
    for (size_t i = 1; i < count; i++)
        if (v[3 * i] > v[3 * most])
            most = i;
    for (size_t i = 0; i < 3 * starg_mesh_face_count(a); i++)
        if (faces[i] == most)
            other = faces[i / 3 * 3 + (i + 1) % 3];
    for (size_t k = 0; k < 3; k++)
        images[3 * most + k] = v[3 * most + k] + far * (v[3 * other + k] - v[3 * most + k]);
}

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* How far p is from a + s (b - a) + t (c - a), which is left out unless it lies in the triangle. */
static double distance_at(const double *const c[3], double s, double t, const double p[3]) {
    double off[3];
    for (int k = 0; k < 3; k++)
        off[k] = (1 - s - t) * c[0][k] + s * c[1][k] + t * c[2][k] - p[k];
    return s >= 0 && t >= 0 && s + t <= 1 ? length_of(off) : INFINITY;
}

static double dot_of(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* From a triangle: at a corner, inside an edge, or inside, where the gradient vanishes. */
static double distance_from_face(const double *const c[3], const double p[3]) {
    double u[3], v[3], w[3], least = INFINITY;
    for (int k = 0; k < 3; k++) {
        u[k] = c[1][k] - c[0][k];
        v[k] = c[2][k] - c[0][k];
        w[k] = p[k] - c[0][k];
    }
    double uu = dot_of(u, u), uv = dot_of(u, v), vv = dot_of(v, v), uw = dot_of(u, w),
           vw = dot_of(v, w), det = uu * vv - uv * uv;
    double along = (uw - vw + vv - uv) / (uu - 2 * uv + vv); /* from c[2] to c[1] */
    const double at[7][2] = {{0, 0},
                             {1, 0},
                             {0, 1},
                             {uw / uu, 0},
                             {0, vw / vv},
                             {along, 1 - along},
                             {(uw * vv - vw * uv) / det, (vw * uu - uw * uv) / det}};
    for (int i = 0; i < 7; i++)
        least = fmin(least, distance_at(c, at[i][0], at[i][1], p));
    return least;
}

static double distance_from(const starg_mesh *b, const double p[3]) {
    double least = INFINITY;
    for (size_t f = 0; f < starg_mesh_face_count(b); f++) {
        const double *c[3];
        for (size_t k = 0; k < 3; k++)
            c[k] = starg_mesh_vertices(b) + 3 * (size_t)starg_mesh_faces(b)[3 * f + k];
        least = fmin(least, distance_from_face(c, p));
    }
    return least;
}

/* A surface that cannot be met as it is: it is met elsewhere, or nearly. */
static void check_folded(starg_context *context, const starg_mesh *a, double far) {
    starg_mesh *b, *image;
    size_t count = starg_mesh_vertex_count(a), strayed = 0;
    double *images = malloc(3 * count * sizeof *images), farthest = 0;
    double lower[3] = {INFINITY, INFINITY, INFINITY}, size[3] = {0, 0, 0};
    starg_solid_map *map;
    starg_check *report;
    assert_non_null(images);
    fold(a, far, images);
    for (size_t i = 0; i < 3 * count; i++)
        lower[i % 3] = fmin(lower[i % 3], images[i]);
    for (size_t i = 0; i < 3 * count; i++)
        size[i % 3] = fmax(size[i % 3], images[i] - lower[i % 3]);
    b = moved(context, a, images);
    test_ok(context, starg_mesh_check(context, b, &report));
    assert_false(report->embedded);
    starg_check_free(context, report);
    test_ok(context, starg_solid_map_create(context, a, images, &QUICK, &map));
    check_positive(map, map->vertices);
    check_positive(map, map->images);
    check_boundary(context, map, map->vertices, a, starg_mesh_vertices(a));
    image = moved(context, a, map->images);
    assert_true(is_verified(context, a, image, map, true));
    assert_false(is_verified(context, a, b, map, false));
    for (size_t v = 0; v < count; v++) {
        double off = distance_from(b, map->images + 3 * v) / length_of(size);
        strayed += off > 1e-9;
        farthest = fmax(farthest, off);
    }
    assert_int_equal(strayed, map->strayed);
    assert_true(fabs(farthest - map->farthest) < 1e-9 && farthest <= 0.02);
    printf("%zu of %zu vertices are off, by %g at most\n", strayed, count, farthest);
    starg_solid_map_free(context, map);
    starg_mesh_free(b);
    starg_mesh_free(image);
    free(images);
}

static void test_folded(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a = test_sample_mesh(context, "sphere", VERTICES);
    check_folded(context, a, 1.7);
    check_folded(context, a, 4);
    starg_mesh_free(a);
    test_context_free(context);
}

/* ---- morphs ---- */

/* The tetrahedra move straight between keys: positive by Sturm's theorem. */
static void check_steps(const starg_solid_map *map) {
    for (size_t step = 0; step <= map->key_count; step++) {
        const double *rows[2];
        for (size_t end = 0; end < 2; end++) {
            size_t key = step + end;
            rows[end] = key == 0               ? map->vertices
                        : key > map->key_count ? map->images
                                               : map->keys + 3 * (key - 1) * map->vertex_count;
        }
        for (size_t t = step % 23; t < map->count; t += 23) { /* all of them take minutes */
            const double *from[4], *to[4];
            for (size_t k = 0; k < 4; k++) {
                from[k] = rows[0] + 3 * (size_t)map->tetrahedra[4 * t + k];
                to[k] = rows[1] + 3 * (size_t)map->tetrahedra[4 * t + k];
            }
            if (!oracle_stays_positive(from, to))
                fail_msg("tetrahedron %zu is inverted after key %zu", t, step);
        }
    }
}

static void test_morph_solid(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    starg_mesh *a = test_pose(context, "cat", 0, VERTICES),
               *b = test_pose(context, "cat", 2, VERTICES);
    starg_morph *morph = test_morph(context, a, starg_mesh_vertices(b), STARG_MORPH_SOLID);
    starg_solid_map *map;
    test_ok(context, starg_morph_solid_map(morph, &map));
    assert_true(map->key_count > 0);
    assert_int_equal(starg_morph_key_count(morph), map->key_count + 2);
    assert_int_equal(starg_morph_tetrahedron_count(morph), map->count);
    check(context, a, b, map);
    check_steps(map);
    /* frames at keys are the keys */
    size_t size = 3 * starg_mesh_vertex_count(a);
    double *frame = malloc(size * sizeof *frame);
    assert_non_null(frame);
    test_ok(context, starg_morph_frame(morph, map->times[3], frame));
    assert_memory_equal(frame, map->keys + 3 * (3 * map->vertex_count), size * sizeof *frame);
    /* a key that turns a tetrahedron over is found */
    uint32_t moved_vertex = map->tetrahedra[0];
    for (size_t k = 0; k < 3; k++)
        map->keys[3 * (map->vertex_count + moved_vertex) + k] += 5;
    assert_false(is_verified(context, a, b, map, false));
    free(frame);
    starg_solid_map_free(context, map);
    starg_morph_free(morph);
    morph = test_morph(context, a, starg_mesh_vertices(b), STARG_MORPH_LINEAR);
    assert_int_equal(starg_morph_solid_map(morph, &map), STARG_ERROR_ARGUMENT);
    starg_morph_free(morph);
    starg_mesh_free(a);
    starg_mesh_free(b);
    test_context_free(context);
}

/* ---- forgeries ---- */

static void test_forged(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    need_cats();
    starg_context *context = cats.context;
    const starg_mesh *a = cats.a, *b = cats.b;
    starg_solid_map *map = cats.map;
    size_t last = 3 * map->vertex_count - 1;
    assert_true(map->vertex_count > starg_mesh_vertex_count(a));
    double before = map->images[last];
    map->images[last] += 10; /* an inner vertex far outside */
    assert_false(is_verified(context, a, b, map, false));
    map->images[last] = before;
    before = map->images[0];
    map->images[0] += 1e-4; /* off B's surface */
    assert_false(is_verified(context, a, b, map, false));
    map->images[0] = before;
    before = map->mean;
    map->mean *= 1.01;
    assert_false(is_verified(context, a, b, map, false));
    map->mean = before;
    assert_true(is_verified(context, a, b, map, true));
    before = map->guard_images[0];
    map->guard_images[0] += 10;
    assert_false(is_verified(context, a, b, map, false));
    map->guard_images[0] = before;
    map->count--; /* a hole */
    assert_false(is_verified(context, a, b, map, false));
    map->count++;
    assert_false(is_verified(context, a, a, map, false)); /* another target */
}

/* ---- bad ends ---- */

static void test_refused(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    starg_context *context = test_context(1);
    const starg_solid_map_options *options = test_rounds(0, 1) == 1 ? NULL : &QUICK;
    shape s = shape_cube(3);
    starg_mesh *a = test_mesh_of(context, &s);
    size_t size = 3 * starg_mesh_vertex_count(a);
    double *images = malloc(size * sizeof *images);
    starg_solid_map *map;
    assert_non_null(images);
    for (size_t i = 0; i < size; i++) /* mirrored */
        images[i] = starg_mesh_vertices(a)[i] * (i % 3 == 0 ? -1 : 1);
    assert_int_equal(starg_solid_map_create(context, a, images, options, &map), STARG_ERROR_MESH);
    assert_null(map);
    memcpy(images, starg_mesh_vertices(a), size * sizeof *images);
    for (size_t k = 0; k < 3; k++) /* a vertex through the other side */
        images[k] = 4 + 0.3 * (double)k;
    assert_int_equal(starg_solid_map_create(context, a, images, options, &map), STARG_ERROR_MESH);
    images[0] = NAN;
    assert_int_equal(starg_solid_map_create(context, a, images, options, &map), STARG_ERROR_RANGE);
    starg_mesh_free(a);
    shape_free(&s);
    free(images);
    test_context_free(context);
}

/* ---- points and files ---- */

static char *whole_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static void check_files(starg_context *context, const starg_solid_map *map) {
    const char *path = "test_solid_map.vtu";
    starg_solid_map *read;
    size_t size;
    test_ok(context, starg_solid_map_write(context, map, path));
    char *bytes = whole_file(path, &size);
    test_ok(context, starg_solid_map_read_memory(context, bytes, size, path, &read));
    assert_int_equal(read->count, map->count);
    assert_int_equal(read->vertex_count, map->vertex_count);
    assert_int_equal(read->piece_count, map->piece_count);
    assert_memory_equal(read->images, map->images, 3 * map->vertex_count * sizeof(double));
    assert_memory_equal(read->vertices, map->vertices, 3 * map->vertex_count * sizeof(double));
    assert_memory_equal(read->tetrahedra, map->tetrahedra, 4 * map->count * sizeof(uint32_t));
    assert_true(read->mean == map->mean && read->worst == map->worst);
    starg_solid_map_free(context, read);
    for (size_t cut = 0; cut < size; cut += size / 97 + 1) /* every truncation is refused */
        if (cut + 40 < size)
            assert_int_not_equal(starg_solid_map_read_memory(context, bytes, cut, path, &read),
                                 STARG_OK);
    free(bytes);
    remove(path);
}

/* Corners and centroids of tetrahedra go to those of their images, and back. */
static void check_points(starg_context *context, const starg_solid_map *map) {
    size_t count = map->vertex_count + map->count;
    double *points = calloc(3 * count, sizeof *points), *ends = calloc(3 * count, sizeof *ends);
    double *vectors = calloc(3 * count, sizeof *vectors);
    assert_true(points != NULL && ends != NULL && vectors != NULL);
    memcpy(points, map->vertices, 3 * map->vertex_count * sizeof *points);
    memcpy(ends, map->images, 3 * map->vertex_count * sizeof *ends);
    for (size_t t = 0; t < map->count; t++)
        for (size_t i = 0; i < 12; i++) {
            size_t v = map->tetrahedra[4 * t + i / 3], at = 3 * (map->vertex_count + t) + i % 3;
            points[at] += map->vertices[3 * v + i % 3] / 4;
            ends[at] += map->images[3 * v + i % 3] / 4;
            if (i / 3 < 2) { /* the edge from corner 0 to corner 1 */
                double sign = i / 3 == 0 ? -1 : 1;
                vectors[at] += sign * map->vertices[3 * v + i % 3];
            }
        }
    starg_samples *there, *back,
        samples = {.count = count, .width = 3, .points = points, .values = vectors};
    test_ok(context, starg_solid_map_carry(context, map, &samples, false, &there));
    test_ok(context, starg_solid_map_carry(context, map, there, true, &back));
    for (size_t i = 0; i < 3 * count; i++) {
        assert_true(fabs(there->points[i] - ends[i]) < 1e-9);
        assert_true(fabs(back->points[i] - points[i]) < 1e-9);
    }
    for (size_t t = 0; t < map->count; t++)
        for (size_t k = 0; k < 3; k++) {
            size_t at = 3 * (map->vertex_count + t) + k;
            double edge = map->images[3 * map->tetrahedra[4 * t + 1] + k] -
                          map->images[3 * map->tetrahedra[4 * t] + k];
            assert_true(fabs(there->values[at] - edge) < 1e-9);
        }
    starg_samples_free(context, there);
    starg_samples_free(context, back);
    points[3 * (count - 1)] += 100;
    assert_int_equal(starg_solid_map_carry(context, map, &samples, false, &there),
                     STARG_ERROR_MESH);
    assert_null(there);
    assert_int_equal(starg_context_error(context)->indices[0], count - 1);
    free(points);
    free(ends);
    free(vectors);
}

static void test_points(void **state) {
    (void)state;
    if (!has_tetgen())
        skip();
    need_cats();
    check_files(cats.context, cats.map);
    check_points(cats.context, cats.map);
}

static void test_samples(void **state) {
    (void)state;
    static const char *const bad[] = {"1 2\n",       "1 2 3\n1 2 3 4\n", "1 2 x\n",
                                      "# nothing\n", "1 2 3 4 5\n",      "1 2 1e200\n"};
    starg_context *context = test_context(1);
    const char *path = "test_samples.txt";
    starg_samples *samples;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        fputs(bad[i], file);
        fclose(file);
        assert_int_equal(starg_samples_read(context, path, &samples), STARG_ERROR_FORMAT);
        assert_null(samples);
    }
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("# a field\n1 2 3 0.5\n\n4 5 6 -7 # here\n", file);
    fclose(file);
    test_ok(context, starg_samples_read(context, path, &samples));
    assert_int_equal(samples->count, 2);
    assert_int_equal(samples->width, 1);
    assert_true(samples->points[5] == 6 && samples->values[1] == -7);
    starg_samples_free(context, samples);
    remove(path);
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_poses),
        cmocka_unit_test(test_handles),
        cmocka_unit_test(test_small_end),
        cmocka_unit_test(test_descent),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_forged),
        cmocka_unit_test(test_morph_solid),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_samples),
        cmocka_unit_test(test_few_pieces),
        cmocka_unit_test(test_overlay),
        cmocka_unit_test(test_overlay_of_balls),
        cmocka_unit_test(test_folded),
    };
    return cmocka_run_group_tests(tests, NULL, free_cats);
}
