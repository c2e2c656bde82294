/* SPDX-License-Identifier: Apache-2.0 */
/* The verifier of guards: its arithmetic and geometry against rationals, true results that must
 * pass, and results with one error that must fail the right claim. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gmp.h>

#include "adversarial.h"
#include "exact_oracle.h"
#include "models.h"
#include "starguard/verify.h"
#include "support.h"
#include "verify/sight.h"
#include "verify/signs.h"
#include "visibility_oracle.h"

/* ---- arithmetic and signs ---- */

enum { ROUNDS = 250, LONG_ROUNDS = 70000, POINTS = 7 };

typedef double (*points)[3];

static void refute(const char *what, point_family family, points x) {
    for (int i = 0; i < POINTS; i++)
        print_error("  {%a, %a, %a}\n", x[i][0], x[i][1], x[i][2]);
    fail_msg("%s, %s", what, point_family_name(family));
}

static void for_all(void check(point_family family, points x)) {
    size_t rounds = test_rounds(ROUNDS, LONG_ROUNDS);
    for (int family = 0; family < POINT_FAMILIES; family++)
        for (uint64_t round = 0; round < rounds; round++) {
            starg_rng rng = starg_rng_make(17, (uint64_t)family, round);
            double x[POINTS][3];
            adversarial_points(&rng, (point_family)family, x, POINTS);
            check((point_family)family, x);
        }
}

/* A sum of products, half of which nearly cancel others. */
static void check_sum(point_family family, points x) {
    exact_sum sum;
    mpq_t total, product, factor;
    mpq_inits(total, product, factor, (mpq_ptr)NULL);
    exact_sum_clear(&sum);
    for (int i = 0; i < 2 * POINTS; i++) {
        const double *f = x[i % POINTS];
        double first = i < POINTS ? f[0] : -nextafter(f[0], i % 2 ? INFINITY : 0);
        exact_sum_add(&sum, first, f[1], f[2]);
        mpq_set_d(product, first);
        mpq_set_d(factor, f[1]);
        mpq_mul(product, product, factor);
        mpq_set_d(factor, f[2]);
        mpq_mul(product, product, factor);
        mpq_add(total, total, product);
        if (exact_sum_sign(&sum) != mpq_sgn(total))
            refute("exact_sum", family, x);
        double value = mpq_get_d(total);
        if (isnormal(value) && !(fabs(exact_sum_value(&sum, 0) - value) <= 0x1p-51 * fabs(value)))
            refute("exact_sum_value", family, x);
    }
    mpq_clears(total, product, factor, (mpq_ptr)NULL);
}

static void test_exact_sum(void **state) {
    (void)state;
    for_all(check_sum);
}

static void check_signs(point_family family, points x) {
    if (verify_side(x[0], x[1], x[2], x[3]) != oracle_orient3d(x[0], x[1], x[2], x[3]))
        refute("verify_side", family, x);
    for (int axis = 0; axis < 3; axis++)
        if (verify_turn(x[0], x[1], x[2], axis) !=
            oracle_orient2d(x[0], x[1], x[2], (axis + 1) % 3, (axis + 2) % 3))
            refute("verify_turn", family, x);
    double distance = hypot(hypot(x[0][0] - x[1][0], x[0][1] - x[1][1]), x[0][2] - x[1][2]);
    const double radii[] = {distance, nextafter(distance, 0), fabs(x[2][0]), 0};
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++)
        if (verify_within(x[0], x[1], radii[i]) !=
            (oracle_compare_distance(x[0], x[1], radii[i]) <= 0))
            refute("verify_within", family, x);
    assert_true(verify_within(x[0], x[1], INFINITY));
}

static void test_signs(void **state) {
    (void)state;
    for_all(check_signs);
}

static void check_shapes(point_family family, points x) {
    const double *t[3] = {x[2], x[3], x[4]}, *face[3] = {x[1], x[5], x[6]};
    bool on = oracle_point_on_triangle(x[0], x[2], x[3], x[4]);
    if (verify_on_triangle(x[0], t) != on)
        refute("verify_on_triangle", family, x);
    if (on)
        return;
    if (verify_blocks(x[0], x[1], t) != oracle_segment_meets_triangle(x[0], x[1], x[2], x[3], x[4]))
        refute("verify_blocks", family, x);
    if (oracle_orient3d(face[0], face[1], face[2], x[0]) <= 0)
        return;
    for (int i = 0; i < 3; i++)
        if (oracle_segment_meets_triangle(x[0], face[i], t[0], t[1], t[2]))
            return;
    const verify_spot part[3] = {verify_plain(face[0]), verify_plain(face[1]),
                                 verify_plain(face[2])};
    if (verify_enters(x[0], face, part, t) != oracle_tetrahedron_meets_triangle(x[0], face, t))
        refute("verify_enters", family, x);
}

/* Points between vertices, some of which are corners of what may hide them, rounded as the doubles
 * of parts are. */
static void check_spots(point_family family, points x) {
    uint64_t bits;
    memcpy(&bits, x[0], sizeof bits);
    starg_rng rng = starg_rng_make(9, (uint64_t)family, bits);
    const double *t[3] = {x[2], x[3], x[4]}, *face[3] = {x[1], x[5], x[6]};
    oracle_mix mix[3];
    double at[3][3], largest = 0;
    verify_spot part[3];
    if (starg_rng_below(&rng, 2) == 0)
        face[1] = x[3];
    for (int i = 0; i < 7; i++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(x[i][k]));
    for (int i = 0; i < 3; i++) { /* weights of halvings: those before, and midpoints */
        part[i] = (verify_spot){.at = at[i], .blur = 0x1p-50 * largest + 0x1p-1070};
        for (int k = 0; k < 3; k++) {
            mix[i].corner[k] = part[i].corner[k] = face[k];
            mix[i].weight[k] = i == k ? (int64_t)VERIFY_UNIT : 0;
        }
    }
    for (int halvings = 0; halvings < 8; halvings++) {
        size_t from = (size_t)starg_rng_below(&rng, 3), to = (from + 1) % 3;
        for (int k = 0; k < 3; k++)
            mix[to].weight[k] = (mix[from].weight[k] + mix[to].weight[k]) / 2;
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            part[i].weight[k] = (double)mix[i].weight[k];
            at[i][k] =
                ((double)mix[i].weight[0] * face[0][k] + (double)mix[i].weight[1] * face[1][k] +
                 (double)mix[i].weight[2] * face[2][k]) /
                VERIFY_UNIT;
        }
    if (oracle_point_on_triangle(x[0], x[2], x[3], x[4]) ||
        oracle_orient3d(face[0], face[1], face[2], x[0]) <= 0)
        return;
    bool hidden = false;
    for (int i = 0; i < 3; i++) {
        bool meets = oracle_mix_hidden(x[0], &mix[i], t);
        hidden = hidden || meets;
        if (verify_blocks_from(verify_side(t[0], t[1], t[2], x[0]), x[0], &part[i], t) != meets)
            refute("verify_blocks_from", family, x);
    }
    if (!hidden && verify_enters(x[0], face, part, t) != oracle_mixes_entered(x[0], mix, t))
        refute("verify_enters", family, x);
}

static void test_spots(void **state) {
    (void)state;
    for_all(check_spots);
}

static void test_shapes(void **state) {
    (void)state;
    for_all(check_shapes);
}

/* Crossing triangles have a common point; triangles in general position with a common point
 * cross. */
static void check_cross(point_family family, points x) {
    const double *s[3] = {x[0], x[1], x[2]}, *t[3] = {x[3], x[4], x[5]};
    bool cross = verify_cross(s, t), contact = oracle_triangles_contact(s, t, 0);
    bool general = true;
    for (int i = 0; i < 3; i++)
        general = general && oracle_orient3d(s[0], s[1], s[2], t[i]) != 0 &&
                  oracle_orient3d(t[0], t[1], t[2], s[i]) != 0;
    if (cross != verify_cross(t, s) || (cross && !contact) || (general && contact && !cross))
        refute("verify_cross", family, x);
}

static void test_cross(void **state) {
    (void)state;
    for_all(check_cross);
    const double a[3] = {0, 0, 0}, b[3] = {4, 0, 0}, c[3] = {0, 4, 0}, d[3] = {4, 4, 0};
    const double e[3] = {1, 1, 0};
    const double *abc[3] = {a, b, c}, *bcd[3] = {b, c, d}, *ebd[3] = {e, b, d};
    assert_true(verify_cross(abc, abc));
    assert_false(verify_cross(abc, bcd)); /* they share only an edge */
    assert_true(verify_cross(abc, ebd));
}

/* ---- solids ---- */

/* The verifier's input, and the same with correctly oriented shells. */
typedef struct model {
    const char *name;
    shape given, turned;
} model;

enum { MODELS = 12 };

static const double TINY = 0x1p-1072; /* four times the smallest number */

static model same(const char *name, shape s) {
    model m = {.name = name, .given = s};
    shape_append(&m.turned, &s, (const double[3]){0}, 0);
    return m;
}

/* A cube of side three and one of side one, each of them reversed or not, both as given and as it
 * should be. */
static model two_cubes(const char *name, double at, int outer_given, int inner_given,
                       int inner_turned) {
    const double nothing[3] = {0}, offset[3] = {at, at, at};
    shape outer = shape_cube(3), inner = shape_cube(1);
    model m = {.name = name};
    shape_append(&m.given, &outer, nothing, outer_given);
    shape_append(&m.given, &inner, offset, inner_given);
    shape_append(&m.turned, &outer, nothing, 0);
    shape_append(&m.turned, &inner, offset, inner_turned);
    shape_free(&outer);
    shape_free(&inner);
    return m;
}

static model make_model(int which) {
    model m;
    switch (which) {
    case 0:
        return same("tetrahedron", shape_tetrahedron());
    case 1:
        return same("cube", shape_cube(3));
    case 2:
        return same("room", shape_room());
    case 3:
        return same("cavity", shape_cavity());
    case 4:
        return same("columns", shape_columns());
    case 5:
        m = same("blob", shape_blob(2, 5));
        return m;
    case 6:
        return two_cubes("cavity that faces outward", 1.25, 0, 0, 1);
    case 7:
        return two_cubes("everything inside out", 1.25, 1, 0, 1);
    case 8:
        return two_cubes("cubes side by side, one inside out", 3.5, 0, 1, 0);
    case 9:
        return two_cubes("cubes that cross, one inside out", 2.25, 1, 1, 0);
    case 10: /* half of the inner one's faces are in the wall: a hollow, flush with sides */
        return two_cubes("cubes that overlap in their faces", 2, 0, 0, 1);
    default:
        m = same("tiny room", shape_room());
        shape_place(&m.given, TINY, 0);
        shape_place(&m.turned, TINY, 0);
        return m;
    }
}

static void free_model(model *m) {
    shape_free(&m->given);
    shape_free(&m->turned);
}

static starg_mesh *make_mesh(starg_context *context, const shape *s) {
    starg_mesh *mesh = test_mesh_of(context, s);
    return mesh;
}

/* A point around the model: on its lattice, between, or anywhere. */
static void some_point(starg_rng *rng, const shape *s, double p[3]) {
    double scale = TINY;
    for (size_t i = 0; i < 3 * s->vertex_count; i++)
        if (fabs(s->vertices[i]) > 1e-300)
            scale = 1;
    uint64_t kind = starg_rng_below(rng, 3);
    for (int k = 0; k < 3; k++) {
        double step = kind == 0 ? 0.25 * (double)starg_rng_below(rng, 20) : 5 * starg_rng_unit(rng);
        p[k] = scale * (step - 0.5);
    }
}

static bool is_inside(const shape *s, const double p[3]) {
    bool on_surface;
    int winding = oracle_winding(s->vertices, s->faces, s->face_count, p, &on_surface);
    return !on_surface && winding >= 1;
}

/* Finds an inside point by trial. */
static void inside_point(starg_rng *rng, const shape *s, double p[3]) {
    for (int attempt = 0; attempt < 10000; attempt++) {
        some_point(rng, s, p);
        if (is_inside(s, p))
            return;
    }
    fail_msg("no point inside was found");
}

static void test_turning_and_winding(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int which = 0; which < MODELS; which++) {
        model m = make_model(which);
        starg_mesh *mesh = make_mesh(context, &m.given);
        verify_surface *surface;
        test_ok(context, verify_surface_create(context, mesh, &surface));
        for (size_t f = 0; f < m.turned.face_count; f++) {
            const uint32_t *found = surface->faces + 3 * f, *v = m.turned.faces + 3 * f;
            bool equal = (found[0] == v[0] && found[1] == v[1] && found[2] == v[2]) ||
                         (found[0] == v[1] && found[1] == v[2] && found[2] == v[0]) ||
                         (found[0] == v[2] && found[1] == v[0] && found[2] == v[1]);
            if (!equal)
                fail_msg("%s: face %zu is turned the wrong way", m.name, f);
        }
        for (uint64_t round = 0; round < 60; round++) {
            starg_rng rng = starg_rng_make(18, 0, round);
            double p[3];
            bool expected_on, found_on;
            some_point(&rng, &m.turned, p);
            int expected = oracle_winding(m.turned.vertices, m.turned.faces, m.turned.face_count, p,
                                          &expected_on);
            int found = verify_winding(surface, NULL, surface->face_count, p, &found_on);
            if (found_on != expected_on || (!found_on && found != expected))
                fail_msg("%s at (%a, %a, %a): expected %d, found %d", m.name, p[0], p[1], p[2],
                         expected, found);
        }
        verify_surface_free(surface);
        starg_mesh_free(mesh);
        free_model(&m);
    }
    test_context_free(context);
}

/* Takes away what is farther from p than the range. */
static void in_range(const shape *s, const double p[3], double range, bool *vertices, bool *faces) {
    if (isinf(range))
        return;
    for (size_t f = 0; f < s->face_count; f++)
        for (size_t i = 0; i < 3; i++) {
            const double *q = s->vertices + 3 * (size_t)s->faces[3 * f + i];
            faces[f] = faces[f] && oracle_compare_distance(p, q, range) <= 0;
        }
    for (size_t v = 0; v < s->vertex_count; v++)
        vertices[v] = vertices[v] && oracle_compare_distance(p, s->vertices + 3 * v, range) <= 0;
}

/* Compares what a view holds with what is seen from p however far, by brute force. */
static void compare_view(const model *m, const double p[3], const verify_view *view,
                         const bool *all_vertices, const bool *all_faces, verify_sight *sight) {
    const shape *s = &m->turned;
    bool *vertices = calloc(s->vertex_count, sizeof *vertices);
    bool *faces = calloc(s->face_count, sizeof *faces);
    const uint8_t *found_vertices, *found_faces;
    memcpy(vertices, all_vertices, s->vertex_count * sizeof *vertices);
    memcpy(faces, all_faces, s->face_count * sizeof *faces);
    in_range(s, p, view->range, vertices, faces);
    assert_int_equal(verify_look(sight, p, view, &found_vertices, &found_faces), STARG_OK);
    for (size_t v = 0; v < s->vertex_count; v++)
        if (found_vertices[v] != vertices[v])
            fail_msg("%s from (%a, %a, %a), range %a: vertex %zu, expected %d", m->name, p[0], p[1],
                     p[2], view->range, v, vertices[v]);
    for (size_t f = 0; f < s->face_count; f++)
        if (found_faces[f] != faces[f])
            fail_msg("%s from (%a, %a, %a), range %a: face %zu, rule %d, expected %d", m->name,
                     p[0], p[1], p[2], view->range, f, (int)view->rule, faces[f]);
    free(vertices);
    free(faces);
}

/* Any range, then as far as some vertices are: what hides them may be hardly nearer. */
static void compare_sight(const model *m, const double p[3], starg_face_rule rule,
                          verify_sight *sight) {
    enum { RANGES = 20 };
    const shape *s = &m->turned;
    bool *vertices = calloc(s->vertex_count, sizeof *vertices);
    bool *faces = calloc(s->face_count, sizeof *faces);
    visibility_oracle_vertices(s->vertices, s->vertex_count, s->faces, s->face_count, p, vertices);
    visibility_oracle_faces(s->vertices, s->vertex_count, s->faces, s->face_count, p,
                            rule == STARG_FACES_WHOLE, faces);
    for (size_t r = 0; r < RANGES; r++) {
        const double *q = s->vertices + 3 * (7919 * r % s->vertex_count);
        double range = r == 0 ? INFINITY : hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
        compare_view(m, p, &(verify_view){.range = range, .rule = rule}, vertices, faces, sight);
    }
    free(vertices);
    free(faces);
}

static void test_sight(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int which = 0; which < MODELS; which++) {
        model m = make_model(which);
        starg_mesh *mesh = make_mesh(context, &m.given);
        verify_surface *surface;
        verify_sight *sight;
        test_ok(context, verify_surface_create(context, mesh, &surface));
        test_ok(context, verify_sight_create(surface, &sight));
        for (uint64_t round = 0; round < 2; round++) {
            starg_rng rng = starg_rng_make(18, 1, round);
            double p[3];
            inside_point(&rng, &m.turned, p);
            compare_sight(&m, p, STARG_FACES_VERTICES, sight);
            compare_sight(&m, p, STARG_FACES_WHOLE, sight);
        }
        verify_sight_free(sight);
        verify_surface_free(surface);
        starg_mesh_free(mesh);
        free_model(&m);
    }
    test_context_free(context);
}

/* ---- results ---- */

enum { GUARDS = 2 };

/* A guards result with room for its lists. */
typedef struct result {
    starg_guards guards;
    double positions[3 * GUARDS];
    size_t seen[GUARDS];
    uint32_t *uncovered, *uncovered_vertices; /* with one spare entry */
} result;

static long double face_area(const shape *s, size_t face) {
    long double u[3], v[3], sum = 0;
    const uint32_t *corner = s->faces + 3 * face;
    for (size_t k = 0; k < 3; k++) {
        long double a = s->vertices[3 * (size_t)corner[0] + k];
        u[k] = s->vertices[3 * (size_t)corner[1] + k] - a;
        v[k] = s->vertices[3 * (size_t)corner[2] + k] - a;
    }
    for (int k = 0; k < 3; k++) {
        long double n = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        sum += n * n;
    }
    return sqrtl(sum) / 2;
}

/* Fills in what follows from the positions and options, by brute force. */
static void fill_in(result *r, const shape *s) {
    starg_guards *g = &r->guards;
    const starg_visibility_options *view = &g->options.visibility;
    bool *vertices = calloc(s->vertex_count, sizeof *vertices);
    bool *all_vertices = calloc(s->vertex_count, sizeof *vertices);
    bool *faces = calloc(s->face_count, sizeof *faces);
    bool *all_faces = calloc(s->face_count, sizeof *faces);
    for (size_t i = 0; i < g->count; i++) {
        const double *p = g->positions + 3 * i;
        visibility_oracle_vertices(s->vertices, s->vertex_count, s->faces, s->face_count, p,
                                   vertices);
        visibility_oracle_faces(s->vertices, s->vertex_count, s->faces, s->face_count, p,
                                view->face_rule == STARG_FACES_WHOLE, faces);
        in_range(s, p, view->range, vertices, faces);
        r->seen[i] = 0;
        for (size_t f = 0; f < s->face_count; f++) {
            r->seen[i] += faces[f];
            all_faces[f] = all_faces[f] || faces[f];
        }
        for (size_t v = 0; v < s->vertex_count; v++)
            all_vertices[v] = all_vertices[v] || vertices[v];
    }
    long double covered = 0, total = 0;
    g->uncovered_count = g->uncovered_vertex_count = 0;
    for (size_t f = 0; f < s->face_count; f++) {
        total += face_area(s, f);
        if (all_faces[f])
            covered += face_area(s, f);
        else
            g->uncovered[g->uncovered_count++] = (uint32_t)f;
    }
    for (size_t v = 0; v < s->vertex_count; v++)
        if (!all_vertices[v])
            g->uncovered_vertices[g->uncovered_vertex_count++] = (uint32_t)v;
    g->coverable_faces = s->face_count;
    g->coverable_vertices = s->vertex_count;
    g->coverage_faces = (double)(s->face_count - g->uncovered_count) / (double)s->face_count;
    g->coverage_vertices =
        (double)(s->vertex_count - g->uncovered_vertex_count) / (double)s->vertex_count;
    g->coverage_area = (double)(covered / total);
    free(vertices);
    free(all_vertices);
    free(faces);
    free(all_faces);
}

static void make_result(result *r, const model *m, uint64_t seed,
                        const starg_visibility_options *view) {
    const shape *s = &m->turned;
    *r = (result){0};
    r->uncovered = calloc(s->face_count + 1, sizeof *r->uncovered);
    r->uncovered_vertices = calloc(s->vertex_count + 1, sizeof *r->uncovered_vertices);
    r->guards = (starg_guards){
        .vertex_count = s->vertex_count,
        .face_count = s->face_count,
        .options = {.visibility = *view, .coverage = 1, .redundancy = 1, .max_guards = GUARDS},
        .count = GUARDS,
        .positions = r->positions,
        .seen_faces = r->seen,
        .uncovered = r->uncovered,
        .uncovered_vertices = r->uncovered_vertices,
        .candidate_count = 100,
        .lower_bound = 1,
        .area_bound = 1};
    starg_rng rng = starg_rng_make(19, seed, 0);
    for (size_t i = 0; i < GUARDS; i++)
        inside_point(&rng, s, r->positions + 3 * i);
    fill_in(r, s);
    bool vertices = view->target == STARG_TARGET_VERTICES;
    r->guards.lower_bound = vertices ? r->guards.uncovered_vertex_count < s->vertex_count
                                     : r->guards.uncovered_count < s->face_count;
}

/* Moves all guards to the first one, so that much stays unseen. */
static void gather_guards(result *r, const shape *s) {
    for (size_t i = 1; i < GUARDS; i++)
        memcpy(r->positions + 3 * i, r->positions, 3 * sizeof *r->positions);
    fill_in(r, s);
}

/* A copy to falsify. */
static void copy_result(result *r, const result *from, const shape *s) {
    *r = *from;
    r->uncovered = calloc(s->face_count + 1, sizeof *r->uncovered);
    r->uncovered_vertices = calloc(s->vertex_count + 1, sizeof *r->uncovered_vertices);
    memcpy(r->uncovered, from->uncovered, s->face_count * sizeof *r->uncovered);
    memcpy(r->uncovered_vertices, from->uncovered_vertices,
           s->vertex_count * sizeof *r->uncovered_vertices);
    r->guards.positions = r->positions;
    r->guards.seen_faces = r->seen;
    r->guards.uncovered = r->uncovered;
    r->guards.uncovered_vertices = r->uncovered_vertices;
}

static void free_result(result *r) {
    free(r->uncovered);
    free(r->uncovered_vertices);
}

static const starg_visibility_options PLAIN = {.range = INFINITY, .cone = 360};

static starg_verdict *verify(starg_context *context, const starg_mesh *mesh, const result *r) {
    starg_verdict *verdict;
    test_ok(context, starg_verify_guards(context, mesh, &r->guards, &verdict));
    assert_true(verdict->count >= 10);
    bool all = true;
    for (size_t i = 0; i < verdict->count; i++) {
        assert_true(strlen(verdict->claims[i].text) > 10);
        all = all && verdict->claims[i].holds;
    }
    assert_int_equal(verdict->passed, all);
    return verdict;
}

static void expect_pass(starg_context *context, const starg_mesh *mesh, const result *r,
                        const char *name) {
    starg_verdict *verdict = verify(context, mesh, r);
    for (size_t i = 0; i < verdict->count; i++)
        if (!verdict->claims[i].holds)
            fail_msg("%s: %s", name, verdict->claims[i].text);
    starg_verdict_free(context, verdict);
}

static void test_true_results_pass(void **state) {
    (void)state;
    static const starg_visibility_options views[] = {
        {.range = INFINITY, .cone = 360},
        {.range = INFINITY, .cone = 360, .face_rule = STARG_FACES_WHOLE},
        {.range = INFINITY, .cone = 360, .target = STARG_TARGET_VERTICES},
        {.range = 2.25, .cone = 360},
    };
    starg_context *context = test_context(2);
    for (int which = 0; which < MODELS; which++) {
        model m = make_model(which);
        starg_mesh *mesh = make_mesh(context, &m.given);
        for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
            result r;
            make_result(&r, &m, i, &views[i]);
            expect_pass(context, mesh, &r, m.name);
            free_result(&r);
        }
        starg_mesh_free(mesh);
        free_model(&m);
    }
    test_context_free(context);
}

/* ---- falsified results ---- */

static void move_outside(result *r, const shape *s) {
    (void)s;
    r->positions[3] = 1000;
}

static void move_to_face(result *r, const shape *s) {
    memcpy(r->positions, s->vertices + 3 * (size_t)s->faces[0], 3 * sizeof(double));
}

static void move_nowhere(result *r, const shape *s) {
    (void)s;
    r->positions[5] = NAN;
}

static void miscount_seen(result *r, const shape *s) {
    (void)s;
    r->seen[1]++;
}

static void drop_uncovered(result *r, const shape *s) {
    (void)s;
    starg_guards *g = &r->guards;
    g->uncovered_count--;
    memmove(g->uncovered, g->uncovered + 1, g->uncovered_count * sizeof *g->uncovered);
}

static void add_uncovered(result *r, const shape *s) {
    starg_guards *g = &r->guards;
    uint32_t spare = 0;
    size_t at = 0;
    while (at < g->uncovered_count && g->uncovered[at] == spare) {
        spare++;
        at++;
    }
    assert_true(spare < s->face_count);
    memmove(g->uncovered + at + 1, g->uncovered + at,
            (g->uncovered_count++ - at) * sizeof *g->uncovered);
    g->uncovered[at] = spare;
}

static void exchange_uncovered(result *r, const shape *s) {
    (void)s;
    uint32_t first = r->uncovered[0];
    r->uncovered[0] = r->uncovered[1];
    r->uncovered[1] = first;
}

static void name_missing_face(result *r, const shape *s) {
    r->uncovered[r->guards.uncovered_count++] = (uint32_t)s->face_count;
}

static void raise_coverage(result *r, const shape *s) {
    r->guards.coverage_faces += 1 / (double)s->face_count;
}

static void lower_coverage(result *r, const shape *s) {
    r->guards.coverage_faces -= 1 / (double)s->face_count;
}

static void raise_area(result *r, const shape *s) {
    (void)s;
    r->guards.coverage_area *= 1 + 1e-6;
}

static void raise_bound(result *r, const shape *s) {
    (void)s;
    r->guards.lower_bound = GUARDS + 1;
}

static void call_optimal(result *r, const shape *s) {
    (void)s;
    r->guards.optimal = true;
}

static void deny_optimal(result *r, const shape *s) {
    (void)s;
    r->guards.lower_bound = GUARDS;
}

/* Both guards coincide and are called necessary. */
static void need_duplicates(result *r, const shape *s) {
    (void)s;
    r->guards.lower_bound = GUARDS;
    r->guards.optimal = true;
}

/* A part that one guard sees, with a bound of two. */
static void ask_for_less(result *r, const shape *s) {
    (void)s;
    r->guards.options.max_guards = 0;
    r->guards.options.coverage = 0.5 * r->guards.coverage_area;
    r->positions[3] += 1e-3;
    fill_in(r, s);
    r->guards.lower_bound = GUARDS;
    r->guards.optimal = true;
}

static void raise_everywhere(result *r, const shape *s) {
    (void)s;
    r->guards.lower_bound_everywhere = r->guards.lower_bound + 1;
    r->guards.optimal_everywhere = r->guards.lower_bound_everywhere == GUARDS;
}

static void call_fewest(result *r, const shape *s) {
    (void)s;
    r->guards.lower_bound_everywhere = r->guards.lower_bound;
    r->guards.optimal_everywhere = true;
}

static void demand_clearance(result *r, const shape *s) {
    (void)s;
    r->guards.options.clearance = 0.9;
}

static void lose_vertex(result *r, const shape *s) {
    (void)s;
    r->guards.vertex_count--;
}

static void gain_face(result *r, const shape *s) {
    (void)s;
    r->guards.face_count++;
}

static void lower_coverable(result *r, const shape *s) {
    r->guards.coverable_faces = s->face_count - r->guards.uncovered_count - 1;
}

static void raise_coverable(result *r, const shape *s) {
    r->guards.coverable_faces = s->face_count + 1;
}

/* One coverable face too few. */
static void forget_coverable(result *r, const shape *s) {
    r->guards.coverable_faces = s->face_count - 1;
}

/* Claims that nothing more can be seen than is seen. */
static void deny_coverable(result *r, const shape *s) {
    r->guards.coverable_faces = s->face_count - r->guards.uncovered_count;
    r->guards.options.max_guards = 0;
}

static void leave_coverable(result *r, const shape *s) {
    (void)s;
    r->guards.options.max_guards = 0;
}

static void leave_area(result *r, const shape *s) {
    (void)s;
    r->guards.options.max_guards = 0;
    r->guards.options.coverage = 1 - 1e-6;
}

static void exceed_guards(result *r, const shape *s) {
    (void)s;
    r->guards.options.max_guards = GUARDS - 1;
}

static void lose_candidates(result *r, const shape *s) {
    (void)s;
    r->guards.candidate_count = GUARDS - 1;
}

static void lower_area_bound(result *r, const shape *s) {
    (void)s;
    r->guards.area_bound = r->guards.coverage_area * (1 - 1e-6);
}

static void lower_area_everywhere(result *r, const shape *s) {
    (void)s;
    r->guards.area_bound_everywhere = r->guards.coverage_area * (1 - 1e-6);
}

static void spoil_options(result *r, const shape *s) {
    (void)s;
    r->guards.options.visibility.range = NAN;
}

static void look_behind(result *r, const shape *s) {
    (void)s;
    r->guards.options.visibility.near = -1;
}

static void forget_guards(result *r, const shape *s) {
    r->guards.count = 0;
    fill_in(r, s);
    r->guards.lower_bound = 0;
    r->guards.optimal = true;
}

typedef struct falsification {
    void (*apply)(result *r, const shape *s);
    const char *claim; /* part of the text of the claim that must fail */
    bool alone;        /* only this one fails */
} falsification;

static const falsification FALSIFICATIONS[] = {
    {move_outside, "strictly inside", false},
    {move_to_face, "strictly inside", false},
    {move_nowhere, "strictly inside", false},
    {miscount_seen, "each guard sees", true},
    {drop_uncovered, "faces are seen by no guard: 1 more", true},
    {add_uncovered, "faces are seen by no guard: 1 of them", true},
    {exchange_uncovered, "not ascending", true},
    {name_missing_face, "not ascending", true},
    {raise_coverage, "coverage by faces", true},
    {lower_coverage, "coverage by faces", true},
    {raise_area, "coverage by area", true},
    {raise_bound, "the lower bound", true},
    {call_optimal, "optimal", true},
    {deny_optimal, "optimal", false},
    {need_duplicates, "the lower bound", true},
    {ask_for_less, "the lower bound", true},
    {forget_coverable, "can be seen: more can", true},
    {deny_coverable, "can be seen: more can", true},
    {raise_everywhere, "anywhere", true},
    {call_fewest, "called the fewest possible", true},
    {demand_clearance, "clearance", true},
    {lose_vertex, "the model has", true},
    {gain_face, "the model has", true},
    {lower_coverable, "can be seen (at least", true},
    {raise_coverable, "can be seen (at least", false},
    {leave_coverable, "guards see a fraction", true},
    {leave_area, "guards see a fraction", true},
    {exceed_guards, "are at most", true},
    {lose_candidates, "candidates", true},
    {lower_area_bound, "within its bound", true},
    {lower_area_everywhere, "bound for guards anywhere", true},
    {spoil_options, "options make sense", false},
    {look_behind, "options make sense", false},
    {forget_guards, "there are guards", false},
};

static void expect_failure(starg_context *context, const starg_mesh *mesh, const result *r,
                           const falsification *wrong) {
    starg_verdict *verdict = verify(context, mesh, r);
    bool found = false;
    for (size_t i = 0; i < verdict->count; i++) {
        const starg_claim *claim = &verdict->claims[i];
        bool meant = strstr(claim->text, wrong->claim) != NULL;
        found = found || (meant && !claim->holds);
        if (wrong->alone && !meant && !claim->holds)
            fail_msg("wrong is \"%s\", but what fails is \"%s\"", wrong->claim, claim->text);
    }
    if (!found)
        fail_msg("\"%s\" does not fail", wrong->claim);
    assert_false(verdict->passed);
    starg_verdict_free(context, verdict);
}

static void test_each_falsification_fails(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    for (int which = 3; which <= 5; which++) { /* cavity, columns, blob: some faces stay unseen */
        model m = make_model(which);
        starg_mesh *mesh = make_mesh(context, &m.given);
        result truth;
        make_result(&truth, &m, 1, &PLAIN);
        gather_guards(&truth, &m.turned);
        assert_true(truth.guards.uncovered_count > 1);
        for (size_t i = 0; i < sizeof FALSIFICATIONS / sizeof *FALSIFICATIONS; i++) {
            result r;
            copy_result(&r, &truth, &m.turned);
            FALSIFICATIONS[i].apply(&r, &m.turned);
            expect_failure(context, mesh, &r, &FALSIFICATIONS[i]);
            free_result(&r);
        }
        free_result(&truth);
        starg_mesh_free(mesh);
        free_model(&m);
    }
    test_context_free(context);
}

static void drop_uncovered_vertex(result *r, const shape *s) {
    (void)s;
    r->guards.uncovered_vertex_count--;
}

static void raise_vertex_coverage(result *r, const shape *s) {
    r->guards.coverage_vertices += 1 / (double)s->vertex_count;
}

static void leave_coverable_vertex(result *r, const shape *s) {
    (void)s;
    r->guards.options.max_guards = 0;
}

static void deny_coverable_vertex(result *r, const shape *s) {
    r->guards.coverable_vertices = s->vertex_count - 1;
}

static void test_vertex_falsifications_fail(void **state) {
    (void)state;
    static const falsification wrong[] = {
        {drop_uncovered_vertex, "vertices are seen by no guard", true},
        {raise_vertex_coverage, "coverage by vertices", true},
        {leave_coverable_vertex, "guards see a fraction", true},
        {deny_coverable_vertex, "can be seen: more can", true},
    };
    const starg_visibility_options view = {
        .range = INFINITY, .cone = 360, .target = STARG_TARGET_VERTICES};
    starg_context *context = test_context(1);
    model m = make_model(4);
    starg_mesh *mesh = make_mesh(context, &m.given);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        result r;
        make_result(&r, &m, 1, &view);
        assert_true(r.guards.uncovered_vertex_count > 0);
        wrong[i].apply(&r, &m.turned);
        expect_failure(context, mesh, &r, &wrong[i]);
        free_result(&r);
    }
    starg_mesh_free(mesh);
    free_model(&m);
    test_context_free(context);
}

/* The clearance of a known point, kept and violated by a few ulps. */
static void test_clearance(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    model m = make_model(1);
    starg_mesh *mesh = make_mesh(context, &m.given);
    result r;
    make_result(&r, &m, 0, &PLAIN);
    const double p[3] = {1.5, 1.5, 0.7};
    memcpy(r.positions, p, sizeof p);
    gather_guards(&r, &m.turned);
    r.guards.options.clearance = 0.7;
    expect_pass(context, mesh, &r, m.name);
    r.guards.options.clearance = 0.7 * (1 + 1e-8);
    expect_failure(context, mesh, &r, &(falsification){NULL, "clearance", true});
    free_result(&r);
    starg_mesh_free(mesh);
    free_model(&m);
    test_context_free(context);
}

/* ---- meshes that are not usable, threads, memory ---- */

static void expect_mesh_error(starg_context *context, const shape *s) {
    starg_mesh *mesh = make_mesh(context, s);
    starg_guards guards = {.options = {.visibility = PLAIN, .coverage = 1}};
    starg_verdict *verdict;
    assert_int_equal(starg_verify_guards(context, mesh, &guards, &verdict), STARG_ERROR_MESH);
    assert_null(verdict);
    assert_true(strlen(starg_context_error(context)->message) > 10);
    starg_mesh_free(mesh);
}

static void test_unusable_meshes(void **state) {
    (void)state;
    starg_context *context = test_context(1);
    shape s = shape_cube(2);
    s.face_count--; /* open */
    expect_mesh_error(context, &s);
    s.face_count++;
    uint32_t *face = s.faces + 9, second = face[1];
    face[1] = face[2]; /* one reversed face */
    face[2] = second;
    expect_mesh_error(context, &s);
    face[1] = face[2]; /* a repeated corner */
    expect_mesh_error(context, &s);
    s.face_count = 0;
    expect_mesh_error(context, &s);
    shape_free(&s);
    test_context_free(context);
}

static void test_threads_do_not_show(void **state) {
    (void)state;
    model m = make_model(4);
    result r;
    make_result(&r, &m, 3, &PLAIN);
    move_outside(&r, &m.turned);
    starg_context *contexts[2] = {test_context(1), test_context(4)};
    starg_mesh *meshes[2];
    starg_verdict *verdicts[2];
    for (int i = 0; i < 2; i++) {
        meshes[i] = make_mesh(contexts[i], &m.given);
        verdicts[i] = verify(contexts[i], meshes[i], &r);
    }
    assert_int_equal(verdicts[0]->count, verdicts[1]->count);
    for (size_t i = 0; i < verdicts[0]->count; i++) {
        assert_string_equal(verdicts[0]->claims[i].text, verdicts[1]->claims[i].text);
        assert_int_equal(verdicts[0]->claims[i].holds, verdicts[1]->claims[i].holds);
    }
    for (int i = 0; i < 2; i++) {
        starg_verdict_free(contexts[i], verdicts[i]);
        starg_mesh_free(meshes[i]);
        test_context_free(contexts[i]);
    }
    free_result(&r);
    free_model(&m);
}

static void test_out_of_memory(void **state) {
    (void)state;
    model m = make_model(6);
    result r;
    make_result(&r, &m, 3, &PLAIN);
    size_t left = SIZE_MAX;
    starg_context *context = test_scarce_context(1, &left);
    starg_mesh *mesh = make_mesh(context, &m.given);
    size_t before = starg_context_live_blocks(context);
    starg_status status = STARG_ERROR_MEMORY;
    size_t blocks = 0;
    for (; status != STARG_OK; blocks++) {
        starg_verdict *verdict;
        left = blocks;
        status = starg_verify_guards(context, mesh, &r.guards, &verdict);
        assert_true(status == STARG_OK || status == STARG_ERROR_MEMORY);
        assert_int_equal(verdict != NULL, status == STARG_OK);
        starg_verdict_free(context, verdict);
        assert_int_equal(starg_context_live_blocks(context), before);
    }
    assert_true(blocks > 10);
    starg_mesh_free(mesh);
    test_context_free(context);
    free_result(&r);
    free_model(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact_sum),
        cmocka_unit_test(test_signs),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_spots),
        cmocka_unit_test(test_cross),
        cmocka_unit_test(test_turning_and_winding),
        cmocka_unit_test(test_sight),
        cmocka_unit_test(test_true_results_pass),
        cmocka_unit_test(test_each_falsification_fails),
        cmocka_unit_test(test_vertex_falsifications_fail),
        cmocka_unit_test(test_clearance),
        cmocka_unit_test(test_unusable_meshes),
        cmocka_unit_test(test_threads_do_not_show),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
