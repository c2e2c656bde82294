/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes by their definition: random lattices of rooms, crates that touch, overlap and line up with
 * walls, and sheets; from inside and from outside. Free space is in the room and in no crate; a
 * vertex of the room is visible if nothing meets the segment to it. */
#include "support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
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
    bool outside, soup;
    double *weights; /* by face; NULL: none */
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

static bool sees_vertex(const scene *s, const double p[3], const double q[3]) {
    bool seen = !blocks(&s->model, p, q);
    for (size_t i = 0; i < s->count && seen; i++)
        seen = !blocks(&s->obstacles[i], p, q);
    return seen;
}

/* From the visibility of the vertices. */
static bool sees_face(const scene *s, const double p[3], const bool *vertex, size_t f) {
    int side = oracle_orient3d(corner(&s->model, f, 0), corner(&s->model, f, 1),
                               corner(&s->model, f, 2), p);
    bool seen =
        side == (s->outside || s->soup ? -1 : 1) && (s->weights == NULL || s->weights[f] > 0);
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

/* What p sees: faces, or vertices, of the model. */
static void expect(const scene *s, const double p[3], bool vertices, bool *expected) {
    size_t n = s->model.vertex_count;
    bool *vertex = malloc(n * sizeof *vertex), inside = is_free(s, p);
    assert_non_null(vertex);
    for (size_t v = 0; v < n; v++)
        vertex[v] = inside && sees_vertex(s, p, s->model.vertices + 3 * v);
    for (size_t f = 0; !vertices && f < s->model.face_count; f++)
        expected[f] = sees_face(s, p, vertex, f);
    for (size_t v = 0; vertices && v < n; v++)
        expected[v] = vertex[v] && is_wanted_vertex(s, (uint32_t)v);
    free(vertex);
}

/* Obstacles, whose columns come last, are not targets. */
static void check_engines(const scene *s, bool vertices) {
    size_t columns = vertices ? s->model.vertex_count : s->model.face_count;
    bool *expected = malloc(POINTS * columns * sizeof *expected);
    assert_non_null(expected);
    for (size_t i = 0; i < s->point_count; i++)
        expect(s, s->points + 3 * i, vertices, expected + i * columns);
    for (int engine = 0; engine < 5; engine++) {
        starg_visibility_options options;
        starg_bits *bits = NULL;
        starg_visibility_options_default(&options);
        options.engine = (starg_visibility_engine)engine;
        options.target = vertices ? STARG_TARGET_VERTICES : STARG_TARGET_FACES;
        test_ok(s->context,
                starg_visibility(s->context, s->solid, s->points, s->point_count, &options, &bits));
        for (size_t i = 0; i < s->point_count; i++)
            for (size_t j = 0; j < starg_bits_columns(bits); j++) {
                bool right = j < columns && expected[i * columns + j];
                if (starg_bits_test(bits, i, j) != right)
                    print_error("engine %d, point %zu, column %zu\n", engine, i, j);
                assert_int_equal(starg_bits_test(bits, i, j), right);
            }
        starg_bits_free(bits);
    }
    free(expected);
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

static void test_random_scenes(void **state) {
    (void)state;
    size_t seen = 0;
    for (uint64_t seed = 0; seed < 24; seed++) {
        scene s;
        make(&s, seed);
        pick_points(&s, seed);
        check_engines(&s, false);
        check_engines(&s, true);
        check_boxes(&s, seed);
        seen += s.point_count;
        end(&s);
    }
    assert_true(seen > 60);
}

/* ---- guards ---- */

static void test_guards_of_scenes(void **state) {
    (void)state;
    size_t checked = 0;
    for (uint64_t seed = 0; seed < 20; seed++) {
        scene s;
        starg_guard_options options;
        starg_guards *guards = NULL;
        starg_verdict *verdict = NULL;
        make(&s, seed);
        starg_guard_options_default(&options);
        options.candidate_count = 200;
        options.method = seed % 2 ? STARG_GUARD_ILP : STARG_GUARD_PILP;
        starg_status status = starg_guard(s.context, s.solid, &options, &guards);
        if (status == STARG_ERROR_MESH) { /* crates fill the room */
            end(&s);
            continue;
        }
        test_ok(s.context, status);
        for (size_t g = 0; g < guards->count; g++)
            assert_true(is_free(&s, guards->positions + 3 * g));
        bool *seen = malloc(s.model.face_count * sizeof *seen);
        assert_non_null(seen);
        for (size_t g = 0; g < guards->count; g++) {
            expect(&s, guards->positions + 3 * g, false, seen);
            for (size_t i = 0; i < guards->uncovered_count; i++)
                assert_false(seen[guards->uncovered[i]]);
        }
        free(seen);
        const starg_guards_evidence evidence = {.obstacles = (const starg_mesh *const *)s.others,
                                                .obstacle_count = s.count};
        test_ok(s.context,
                starg_verify_guards_with(s.context, s.mesh, &evidence, guards, &verdict));
        for (size_t i = 0; i < verdict->count; i++)
            if (!verdict->claims[i].holds)
                print_error("seed %d: %s\n", (int)seed, verdict->claims[i].text);
        assert_true(verdict->passed);
        starg_verdict_free(s.context, verdict);
        checked += guards->count;
        starg_guards_free(s.context, guards);
        end(&s);
    }
    assert_true(checked > 15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_scenes),
        cmocka_unit_test(test_guards_of_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
