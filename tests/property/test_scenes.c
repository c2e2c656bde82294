/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes by their definition: random lattices of rooms, crates that touch, overlap and stand in
 * line with walls, and sheets; from inside and from outside; by sensors of all kinds. Free is what
 * is in the room and in no crate; a vertex of the room is seen if nothing meets the segment to it,
 * and if it is in the view; a face if its corners are, from its front or from either side. All in
 * rationals. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "mesh/solid.h"
#include "models.h"
#include "starguard/guard.h"
#include "starguard/space.h"
#include "starguard/verify.h"
#include "starguard/visibility.h"

enum { MOST_OBSTACLES = 4, POINTS = 5, SIDE = 3 };

typedef struct scene {
    starg_context *context;
    shape model, obstacles[MOST_OBSTACLES];
    bool open[MOST_OBSTACLES];
    starg_mesh *mesh, *others[MOST_OBSTACLES];
    size_t count;
    bool outside, soup, two_sided;
    double *weights; /* by face; NULL: none given */
    starg_solid *solid;
    double points[3 * POINTS];
    size_t point_count;
} scene;

/* ---- construction ---- */

static shape block(int nx, int ny, int nz) {
    char cells[SIDE * SIDE * SIDE + 1];
    memset(cells, '#', sizeof cells);
    return shape_cells(cells, nx, ny, nz);
}

static void move(shape *s, const double by[3]) {
    for (size_t i = 0; i < 3 * s->vertex_count; i++)
        s->vertices[i] += by[i % 3];
}

/* A box of lattice cells in the room, or partly out of it. */
static shape random_crate(starg_rng *rng) {
    shape s = block(1 + (int)starg_rng_below(rng, 2), 1 + (int)starg_rng_below(rng, 2),
                    1 + (int)starg_rng_below(rng, 2));
    double by[3];
    for (int k = 0; k < 3; k++)
        by[k] = 0.5 * (double)starg_rng_below(rng, 2 * SIDE) - 0.5;
    move(&s, by);
    return s;
}

/* Some triangles with corners on the lattice. */
static shape random_sheet(starg_rng *rng, size_t faces) {
    shape s = {.vertex_count = 4 + starg_rng_below(rng, 3 * faces), .face_count = faces};
    s.vertices = malloc(3 * s.vertex_count * sizeof *s.vertices);
    s.faces = malloc(3 * s.face_count * sizeof *s.faces);
    assert_true(s.vertices != NULL && s.faces != NULL);
    for (size_t i = 0; i < 3 * s.vertex_count; i++)
        s.vertices[i] = (double)starg_rng_below(rng, SIDE + 1);
    for (size_t f = 0; f < s.face_count; f++) {
        uint32_t first = (uint32_t)starg_rng_below(rng, s.vertex_count);
        for (uint32_t k = 0; k < 3; k++)
            s.faces[3 * f + k] = (uint32_t)((first + k + (k == 2 ? f : 0)) % s.vertex_count);
        if (s.faces[3 * f + 2] == first)
            s.faces[3 * f + 2] = (uint32_t)((first + 2) % s.vertex_count);
    }
    return s;
}

static void make(scene *s, uint64_t seed) {
    starg_rng rng = starg_rng_make(seed, 41, 0);
    starg_space_options options;
    memset(s, 0, sizeof *s);
    s->context = test_context(1);
    uint64_t kind = starg_rng_below(&rng, 4);
    s->outside = kind == 0;
    s->soup = kind == 1;
    s->model = s->outside ? block(2, 1, 2)
               : s->soup  ? random_sheet(&rng, 12)
                          : block(SIDE, SIDE, SIDE);
    s->mesh = test_mesh_of(s->context, &s->model);
    s->count = starg_rng_below(&rng, MOST_OBSTACLES + 1);
    for (size_t i = 0; i < s->count; i++) {
        s->open[i] = starg_rng_below(&rng, 3) == 0;
        s->obstacles[i] =
            s->open[i] ? random_sheet(&rng, 1 + starg_rng_below(&rng, 3)) : random_crate(&rng);
        s->others[i] = test_mesh_of(s->context, &s->obstacles[i]);
    }
    starg_space_options_default(&options);
    options.outside = s->outside;
    options.soup = s->soup;
    options.two_sided = s->two_sided = s->soup && seed % 2 == 0;
    options.standoff_most = s->outside ? 3 : 0;
    test_ok(s->context,
            starg_space_create(s->context, s->mesh, (const starg_mesh *const *)s->others, s->count,
                               &options, &s->solid));
    if (starg_rng_below(&rng, 2) == 0)
        return;
    s->weights = malloc(s->model.face_count * sizeof *s->weights);
    assert_non_null(s->weights);
    for (size_t f = 0; f < s->model.face_count; f++)
        s->weights[f] = f == 0 ? 1 : 0.5 * (double)starg_rng_below(&rng, 4);
    test_ok(s->context, starg_space_weigh(s->solid, s->weights));
}

static void end(scene *s) {
    starg_solid_free(s->solid);
    starg_mesh_free(s->mesh);
    shape_free(&s->model);
    for (size_t i = 0; i < s->count; i++) {
        starg_mesh_free(s->others[i]);
        shape_free(&s->obstacles[i]);
    }
    free(s->weights);
    test_context_free(s->context);
}

/* ---- by definition ---- */

static const double *corner(const shape *s, size_t face, int k) {
    return s->vertices + 3 * (size_t)s->faces[3 * face + (size_t)k];
}

static bool is_on(const shape *s, const double p[3]) {
    for (size_t f = 0; f < s->face_count; f++)
        if (oracle_point_on_triangle(p, corner(s, f, 0), corner(s, f, 1), corner(s, f, 2)))
            return true;
    return false;
}

static bool is_in(const shape *s, const double p[3]) {
    bool on;
    return oracle_winding(s->vertices, s->faces, s->face_count, p, &on) > 0;
}

static bool is_free(const scene *s, const double p[3]) {
    if (is_on(&s->model, p) || (!s->soup && is_in(&s->model, p) == s->outside))
        return false;
    for (size_t i = 0; i < s->count; i++)
        if (is_on(&s->obstacles[i], p) || (!s->open[i] && is_in(&s->obstacles[i], p)))
            return false;
    return true;
}

static bool is_beside(const double p[3], const double q[3], const double *a, const double *b,
                      const double *c) {
    for (int k = 0; k < 3; k++)
        if (fmax(p[k], q[k]) < fmin(a[k], fmin(b[k], c[k])) ||
            fmin(p[k], q[k]) > fmax(a[k], fmax(b[k], c[k])))
            return true;
    return false;
}

static bool blocks(const shape *s, const double p[3], const double q[3]) {
    for (size_t f = 0; f < s->face_count; f++) {
        const double *a = corner(s, f, 0), *b = corner(s, f, 1), *c = corner(s, f, 2);
        if (is_beside(p, q, a, b, c))
            continue;
        /* off its plane, a segment that ends on the triangle meets it only at the end */
        if (oracle_orient3d(a, b, c, p) != 0 && oracle_point_on_triangle(q, a, b, c))
            continue;
        if (oracle_segment_meets_triangle(p, q, a, b, c))
            return true;
    }
    return false;
}

/* ---- sensors ---- */

typedef struct view {
    starg_visibility_options options;
    double directions[3 * POINTS], ups[3 * POINTS];
} view;

/* Limits at which lattices have ties: whole distances, right angles, halves of them; directions
 * along axes, to corners and at random. */
static void make_view(const scene *s, uint64_t seed, view *v) {
    static const double angles[] = {45, 54.735610317245346, 60, 90, 120};
    starg_rng rng = starg_rng_make(seed, 44, 0);
    starg_visibility_options_default(&v->options);
    starg_visibility_options *o = &v->options;
    uint64_t kind = starg_rng_below(&rng, 4);
    if (starg_rng_below(&rng, 2) == 0)
        o->range = 1 + 0.5 * (double)starg_rng_below(&rng, 6);
    if (starg_rng_below(&rng, 2) == 0)
        o->near = fmin(0.5 * (double)(1 + starg_rng_below(&rng, 2)), o->range - 0.5);
    if (starg_rng_below(&rng, 2) == 0)
        o->incidence = angles[starg_rng_below(&rng, 3)];
    if (kind == 1)
        o->cone = angles[starg_rng_below(&rng, 5)];
    if (kind >= 2) {
        o->fov[0] = angles[starg_rng_below(&rng, 5)];
        o->fov[1] = angles[starg_rng_below(&rng, 5)];
        o->up[starg_rng_below(&rng, 3)] = starg_rng_below(&rng, 2) ? 1 : 0;
    }
    for (size_t i = 0; i < 3 * POINTS; i++) {
        const double *at =
            s->model.vertices + 3 * starg_rng_below(&rng, s->model.vertex_count) + i % 3;
        v->directions[i] = i / 3 % 3 == 0   ? (double)(i % 3 == seed % 3)
                           : i / 3 % 3 == 1 ? *at - s->points[i] + 1e-3
                                            : starg_rng_unit(&rng) - 0.5;
        v->ups[i] = kind == 3 ? starg_rng_unit(&rng) - 0.5 : 0;
    }
    o->directions = v->directions;
    o->ups = kind == 3 ? v->ups : NULL;
}

/* Is the vertex q in the view of point i? */
static bool frames(const scene *s, const view *v, size_t i, const double q[3]) {
    static const double y[3] = {0, 1, 0};
    const starg_visibility_options *o = &v->options;
    const double *p = s->points + 3 * i, *d = v->directions + 3 * i, *up = o->up;
    double planes[4][3];
    if ((o->range < 1e100 && oracle_compare_distance(p, q, o->range) > 0) ||
        oracle_compare_distance(p, q, o->near) < 0)
        return false;
    if (o->cone < 360 && oracle_compare_cone(p, d, starg_cone_cosine(o->cone), q) < 0)
        return false;
    if (o->fov[0] == 0)
        return true;
    if (o->ups != NULL)
        up = o->ups + 3 * i;
    else if (up[0] == 0 && up[1] == 0 && up[2] == 0)
        up = y;
    starg_frustum(d, up, o->fov, planes);
    for (int side = 0; side < 4; side++)
        if (oracle_compare_plane(p, planes[side], q) < 0)
            return false;
    return true;
}

/* Is the triangle, whose inner side p is on, seen steeply enough? */
static bool is_steep(const view *v, const double p[3], const double *a, const double *b,
                     const double *c) {
    const double *const corners[3] = {a, b, c};
    double cosine = starg_incidence_cosine(v->options.incidence);
    for (int k = 0; v->options.incidence > 0 && k < 3; k++)
        if (oracle_compare_incidence(a, b, c, p, corners[k], cosine) < 0)
            return false;
    return true;
}

static bool sees_vertex(const scene *s, const view *v, size_t i, const double q[3]) {
    const double *p = s->points + 3 * i;
    bool seen = frames(s, v, i, q) && !blocks(&s->model, p, q);
    for (size_t k = 0; k < s->count && seen; k++)
        seen = !blocks(&s->obstacles[k], p, q);
    return seen;
}

/* By what is known of the vertices. */
static bool sees_face(const scene *s, const view *v, size_t i, const bool *vertex, size_t f) {
    const double *a = corner(&s->model, f, 0), *b = corner(&s->model, f, 1);
    const double *c = corner(&s->model, f, 2), *p = s->points + 3 * i;
    int side = oracle_orient3d(a, b, c, p);
    bool from_front = s->outside || s->soup ? side < 0 : side > 0;
    bool seen = side != 0 && (from_front || s->two_sided) &&
                (s->weights == NULL || s->weights[f] > 0) &&
                (side > 0 ? is_steep(v, p, a, b, c) : is_steep(v, p, a, c, b));
    for (size_t k = 0; k < 3 && seen; k++)
        seen = vertex[s->model.faces[3 * f + k]];
    return seen;
}

/* Of coincident vertices the first one represents all. */
static bool is_wanted_vertex(const scene *s, uint32_t v) {
    const double *at = s->model.vertices, *q = at + 3 * (size_t)v;
    bool wanted = false;
    for (uint32_t u = 0; u < v; u++)
        if (memcmp(at + 3 * (size_t)u, q, 3 * sizeof *q) == 0)
            return false;
    for (size_t k = 0; k < 3 * s->model.face_count; k++)
        wanted = wanted || (memcmp(at + 3 * (size_t)s->model.faces[k], q, 3 * sizeof *q) == 0 &&
                            (s->weights == NULL || s->weights[k / 3] > 0));
    return wanted;
}

/* ---- comparing ---- */

/* Anywhere, on the half-lattice, and an ulp off it. */
static void pick_points(scene *s, uint64_t seed) {
    for (uint64_t attempt = 0; attempt < 300 && s->point_count < POINTS; attempt++) {
        starg_rng rng = starg_rng_make(seed, 42, attempt);
        double p[3];
        for (int k = 0; k < 3; k++) {
            double x = (SIDE + 2) * starg_rng_unit(&rng) - 1;
            p[k] = attempt % 3 == 0 ? x : 0.5 * round(2 * x);
            if (attempt % 3 == 2 && starg_rng_below(&rng, 4) == 0)
                p[k] = nextafter(p[k], starg_rng_below(&rng, 2) ? INFINITY : -INFINITY);
        }
        bool free_by_definition = is_free(s, p);
        if (starg_solid_contains(s->solid, p) != free_by_definition)
            print_error("seed %d: (%.17g, %.17g, %.17g)%s%s\n", (int)seed, p[0], p[1], p[2],
                        s->outside ? " outside" : "", s->soup ? " soup" : "");
        assert_int_equal(starg_solid_contains(s->solid, p), free_by_definition);
        if (free_by_definition || attempt % 10 == 0)
            memcpy(s->points + 3 * s->point_count++, p, sizeof p);
    }
}

/* What point i sees: faces, or vertices, of the model. */
static void expect(const scene *s, const view *v, size_t i, bool vertices, bool *expected) {
    size_t n = s->model.vertex_count;
    bool *vertex = malloc(n * sizeof *vertex), inside = is_free(s, s->points + 3 * i);
    assert_non_null(vertex);
    for (size_t k = 0; k < n; k++)
        vertex[k] = inside && sees_vertex(s, v, i, s->model.vertices + 3 * k);
    for (size_t f = 0; !vertices && f < s->model.face_count; f++)
        expected[f] = sees_face(s, v, i, vertex, f);
    for (size_t k = 0; vertices && k < n; k++)
        expected[k] = vertex[k] && is_wanted_vertex(s, (uint32_t)k);
    free(vertex);
}

/* Obstacles, whose columns come last, are no targets. Returns how much was seen. */
static size_t check_engines(const scene *s, view *v, bool vertices) {
    size_t columns = vertices ? s->model.vertex_count : s->model.face_count, seen = 0;
    bool *expected = malloc(POINTS * columns * sizeof *expected);
    assert_non_null(expected);
    starg_visibility_options *options = &v->options;
    options->target = vertices ? STARG_TARGET_VERTICES : STARG_TARGET_FACES;
    for (size_t i = 0; i < s->point_count; i++)
        expect(s, v, i, vertices, expected + i * columns);
    for (int engine = 0; engine < 5; engine++) {
        starg_bits *bits = NULL;
        options->engine = (starg_visibility_engine)engine;
        test_ok(s->context,
                starg_visibility(s->context, s->solid, s->points, s->point_count, options, &bits));
        for (size_t i = 0; i < s->point_count; i++)
            for (size_t j = 0; j < starg_bits_columns(bits); j++) {
                bool right = j < columns && expected[i * columns + j];
                seen += right;
                if (starg_bits_test(bits, i, j) != right)
                    print_error("engine %d, point %zu, column %zu\n", engine, i, j);
                assert_int_equal(starg_bits_test(bits, i, j), right);
            }
        starg_bits_free(bits);
    }
    free(expected);
    return seen;
}

/* What a point sees must be visible from every box that contains it. */
static void check_boxes(const scene *s, uint64_t seed) {
    double boxes[6 * POINTS];
    starg_bits *point = NULL, *box = NULL;
    for (size_t i = 0; i < s->point_count; i++) {
        starg_rng rng = starg_rng_make(seed, 43, i);
        double size = ldexp(1, -(int)starg_rng_below(&rng, 6));
        for (size_t k = 0; k < 3; k++) {
            boxes[6 * i + k] = s->points[3 * i + k] - size * starg_rng_unit(&rng);
            boxes[6 * i + k + 3] = s->points[3 * i + k] + size * starg_rng_unit(&rng);
        }
    }
    test_ok(s->context,
            starg_visibility(s->context, s->solid, s->points, s->point_count, NULL, &point));
    test_ok(s->context,
            starg_visibility_region(s->context, s->solid, boxes, s->point_count, NULL, &box));
    for (size_t i = 0; i < s->point_count; i++)
        for (size_t j = 0; j < starg_bits_columns(point); j++)
            if (starg_bits_test(point, i, j))
                assert_true(starg_bits_test(box, i, j));
    starg_bits_free(point);
    starg_bits_free(box);
}

/* A sample, or twenty times as many where all are wanted. */
static uint64_t scenes_of(uint64_t few) {
    return test_rounds(few + few / 2, 100 * few);
}

static void test_random_scenes(void **state) {
    (void)state;
    size_t points = 0;
    for (uint64_t seed = 0; seed < scenes_of(16); seed++) {
        scene s;
        view all = {0};
        starg_visibility_options_default(&all.options);
        make(&s, seed);
        pick_points(&s, seed);
        check_engines(&s, &all, false);
        check_engines(&s, &all, true);
        check_boxes(&s, seed);
        points += s.point_count;
        end(&s);
    }
    assert_true(points > 30);
}

static void test_random_sensors(void **state) {
    (void)state;
    size_t seen = 0;
    for (uint64_t seed = 100; seed < 100 + scenes_of(30); seed++) {
        scene s;
        view v;
        make(&s, seed);
        pick_points(&s, seed);
        make_view(&s, seed, &v);
        seen += check_engines(&s, &v, false);
        if (v.options.incidence == 0)
            seen += check_engines(&s, &v, true);
        end(&s);
    }
    assert_true(seen > 500);
}

/* ---- faces that guards are bound to ---- */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance_to_edge(const double p[3], const double a[3], const double b[3]) {
    double along[3], to[3], left[3];
    for (int k = 0; k < 3; k++) {
        along[k] = b[k] - a[k];
        to[k] = p[k] - a[k];
    }
    double t = fmin(1, fmax(0, dot(along, along) > 0 ? dot(to, along) / dot(along, along) : 0));
    for (int k = 0; k < 3; k++)
        left[k] = to[k] - t * along[k];
    return sqrt(dot(left, left));
}

/* To the plane, if the foot is on the right side of all edges, else to the nearest edge. */
static double distance_to(const double p[3], const double *const t[3]) {
    double u[3], v[3], n[3], to[3], least = INFINITY;
    bool above = true;
    for (int k = 0; k < 3; k++) {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
        to[k] = p[k] - t[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (int e = 0; e < 3; e++) {
        const double *a = t[e], *b = t[(e + 1) % 3];
        double side[3];
        for (int k = 0; k < 3; k++) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            side[k] = n[i] * (b[j] - a[j]) - n[j] * (b[i] - a[i]);
        }
        double from[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
        above = above && dot(side, from) >= 0;
        least = fmin(least, distance_to_edge(p, a, b));
    }
    return above && dot(n, n) > 0 ? fabs(dot(n, to)) / sqrt(dot(n, n)) : least;
}

/* Over one of the faces, with the same rounding of the foot, and near one: one by one, in
 * rationals. */
static bool is_bound(const scene *s, const starg_space_options *o, const double p[3]) {
    bool over = o->over_count == 0, near = o->mount_count == 0;
    double foot[3];
    for (int k = 0; k < 3; k++)
        foot[k] = p[k] - o->height * o->up[k];
    for (size_t i = 0; i < o->over_count; i++)
        over = over || oracle_segment_meets_triangle(p, foot, corner(&s->model, o->over[i], 0),
                                                     corner(&s->model, o->over[i], 1),
                                                     corner(&s->model, o->over[i], 2));
    for (size_t i = 0; i < o->mount_count; i++) {
        const double *t[3];
        for (int k = 0; k < 3; k++)
            t[k] = corner(&s->model, o->mount[i], k);
        near = near || distance_to(p, t) <= o->mount_distance;
    }
    return over && near;
}

static size_t pick_faces(starg_rng *rng, size_t faces, uint32_t *list) {
    size_t count = 0;
    uint64_t one_in = 1 + starg_rng_below(rng, 20);
    for (uint32_t f = 0; f < faces; f++)
        if (starg_rng_below(rng, one_in) == 0)
            list[count++] = f;
    return count;
}

/* Who may stand where, and no box that is barred has such a place in it. */
static size_t check_bound(const scene *s, const starg_space_options *o, starg_rng *rng) {
    size_t admitted = 0;
    starg_solid *bound = NULL;
    test_ok(s->context,
            starg_space_create(s->context, s->mesh, (const starg_mesh *const *)s->others, s->count,
                               o, &bound));
    for (int i = 0; i < 60; i++) {
        double p[3], size = ldexp(1, -(int)starg_rng_below(rng, 8));
        bvh_box box;
        for (int k = 0; k < 3; k++) {
            p[k] = (SIDE + 1) * starg_rng_unit(rng) - 0.5;
            p[k] = i % 2 == 0 ? p[k] : 0.5 * round(2 * p[k]);
            box.lower[k] = p[k] - size * starg_rng_unit(rng);
            box.upper[k] = p[k] + size * starg_rng_unit(rng);
        }
        bool expected = is_free(s, p) && is_bound(s, o, p);
        assert_int_equal(starg_space_admits(bound, p), expected);
        admitted += expected;
        if (expected)
            assert_false(solid_bars(bound, &box));
    }
    starg_solid_free(bound);
    return admitted;
}

static void test_bound_guards(void **state) {
    (void)state;
    size_t admitted = 0;
    for (uint64_t seed = 300; seed < 300 + scenes_of(30); seed++) {
        scene s;
        starg_rng rng = starg_rng_make(seed, 45, 0);
        starg_space_options options;
        make(&s, seed);
        uint32_t *list = malloc(2 * s.model.face_count * sizeof *list);
        assert_non_null(list);
        starg_space_options_default(&options);
        options.outside = s.outside;
        options.soup = s.soup;
        options.over = list;
        options.mount = list + s.model.face_count;
        if (seed % 3 != 0)
            options.over_count = pick_faces(&rng, s.model.face_count, options.over);
        if (seed % 3 != 1)
            options.mount_count = pick_faces(&rng, s.model.face_count, options.mount);
        options.height = 0.5 * (double)(1 + starg_rng_below(&rng, 4));
        options.mount_distance = 0.3 + starg_rng_unit(&rng);
        options.up[starg_rng_below(&rng, 3)] = starg_rng_below(&rng, 2) ? 1 : -1;
        admitted += check_bound(&s, &options, &rng);
        free(list);
        end(&s);
    }
    assert_true(admitted > 40);
}

/* ---- guards ---- */

static starg_status guard_scene(const scene *s, const view *v, bool ilp, starg_guards **out) {
    starg_guard_options options;
    starg_guard_options_default(&options);
    options.candidate_count = 200;
    options.method = ilp ? STARG_GUARD_ILP : STARG_GUARD_PILP;
    options.visibility = v->options;
    options.visibility.directions = options.visibility.ups = NULL;
    options.visibility.patch = STARG_PATCH_OFF; /* parts of faces: test_patches */
    return starg_guard(s->context, s->solid, &options, out);
}

/* What is said to be seen by no guard is seen by none. */
static void check_uncovered(scene *s, const view *v, const starg_guards *guards) {
    bool *seen = malloc(s->model.face_count * sizeof *seen);
    assert_non_null(seen);
    for (size_t g = 0; g < guards->count; g++) {
        view own = *v;
        memcpy(s->points, guards->positions + 3 * g, 3 * sizeof *s->points);
        own.options.directions = guards->directions != NULL ? guards->directions + 3 * g : NULL;
        own.options.ups = guards->ups != NULL ? guards->ups + 3 * g : NULL;
        for (int k = 0; guards->directions != NULL && k < 3; k++)
            own.directions[k] = own.options.directions[k];
        assert_true(is_free(s, s->points));
        expect(s, &own, 0, false, seen);
        for (size_t i = 0; i < guards->uncovered_count; i++)
            assert_false(seen[guards->uncovered[i]]);
    }
    free(seen);
}

static void check_verdict(const scene *s, uint64_t seed, const starg_guards *guards) {
    starg_verdict *verdict = NULL;
    const starg_guards_evidence evidence = {.obstacles = (const starg_mesh *const *)s->others,
                                            .obstacle_count = s->count};
    test_ok(s->context, starg_verify_guards_with(s->context, s->mesh, &evidence, guards, &verdict));
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            print_error("seed %d: %s\n", (int)seed, verdict->claims[i].text);
    assert_true(verdict->passed);
    starg_verdict_free(s->context, verdict);
}

static void test_guards_of_scenes(void **state) {
    (void)state;
    size_t checked = 0, aimed = 0;
    for (uint64_t seed = 0; seed < scenes_of(16); seed++) {
        scene s;
        view v = {0};
        starg_guards *guards = NULL;
        make(&s, seed);
        starg_visibility_options_default(&v.options);
        if (seed % 2 == 1)
            make_view(&s, seed, &v);
        starg_status status = guard_scene(&s, &v, seed % 4 < 2, &guards);
        if (status == STARG_ERROR_MESH) { /* crates fill the room, or nobody sees anything */
            end(&s);
            continue;
        }
        test_ok(s.context, status);
        check_uncovered(&s, &v, guards);
        check_verdict(&s, seed, guards);
        checked += guards->count;
        aimed += guards->directions != NULL ? guards->count : 0;
        starg_guards_free(s.context, guards);
        end(&s);
    }
    assert_true(checked > 15 && aimed > 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_scenes),
        cmocka_unit_test(test_random_sensors),
        cmocka_unit_test(test_bound_guards),
        cmocka_unit_test(test_guards_of_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
