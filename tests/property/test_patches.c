/* SPDX-License-Identifier: Apache-2.0 */
/* Faces seen in parts, against the definition of docs/visibility.md: halving is done anew, corners
 * are rationals, and every line of sight is held against every face. Doubles decide only what is
 * certain in spite of their rounding. */
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rng.h"
#include "exact_oracle.h"
#include "guard/stages.h"
#include "models.h"
#include "starguard/space.h"
#include "starguard/verify.h"
#include "starguard/visibility.h"

static const int64_t UNIT = (int64_t)1 << ORACLE_DEPTH;

/* ---- halving by the rule of the page ---- */

typedef struct part {
    size_t face;
    int64_t weight[3][3]; /* of the corners, by the vertices of the face */
    double share;
} part;

typedef struct division {
    size_t count, capacity;
    part *parts;
} division;

static double edge_square(const part *p, int k, const double *const v[3]) {
    const int64_t *from = p->weight[k], *to = p->weight[(k + 1) % 3];
    double e1 = (double)(to[1] - from[1]) / (double)UNIT;
    double e2 = (double)(to[2] - from[2]) / (double)UNIT;
    double d[3];
    for (int i = 0; i < 3; i++)
        d[i] = e1 * (v[1][i] - v[0][i]) + e2 * (v[2][i] - v[0][i]);
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

static void divide(division *d, const part *p, const double *const v[3], double longest) {
    double square[3];
    int k = 0;
    for (int i = 0; i < 3; i++) {
        square[i] = edge_square(p, i, v);
        k = square[i] > square[k] ? i : k;
    }
    if (!(square[k] > longest * longest)) {
        if (d->count == d->capacity) {
            d->capacity = 2 * d->capacity + 64;
            d->parts = realloc(d->parts, d->capacity * sizeof *d->parts);
            assert_non_null(d->parts);
        }
        d->parts[d->count++] = *p;
        return;
    }
    for (int child = 0; child < 2; child++) { /* the first keeps corner k, the second the next */
        part half = *p;
        int64_t *moved = half.weight[child == 0 ? (k + 1) % 3 : k];
        half.share = p->share / 2;
        for (int i = 0; i < 3; i++) {
            int64_t sum = p->weight[k][i] + p->weight[(k + 1) % 3][i];
            assert_int_equal(sum % 2, 0);
            moved[i] = sum / 2;
        }
        divide(d, &half, v, longest);
    }
}

static void corners_of(const starg_mesh *mesh, size_t face, const double *v[3]) {
    for (size_t i = 0; i < 3; i++)
        v[i] = starg_mesh_vertices(mesh) + 3 * (size_t)starg_mesh_faces(mesh)[3 * face + i];
}

/* The first `faces`; others are a part each. */
static division divide_all(const starg_mesh *mesh, size_t faces, double longest) {
    division d = {0};
    for (size_t f = 0; f < starg_mesh_face_count(mesh); f++) {
        const double *v[3];
        part whole = {f, {{UNIT, 0, 0}, {0, UNIT, 0}, {0, 0, UNIT}}, 1};
        corners_of(mesh, f, v);
        divide(&d, &whole, v, f < faces ? longest : INFINITY);
    }
    return d;
}

static oracle_mix corner_of(const starg_mesh *mesh, const part *p, int k) {
    oracle_mix mix;
    corners_of(mesh, p->face, mix.corner);
    memcpy(mix.weight, p->weight[k], sizeof mix.weight);
    return mix;
}

/* Rounded: a sum in doubles in the order of the vertices' numbers. */
static void round_corner(const oracle_mix *mix, double at[3]) {
    int order[3] = {0, 1, 2};
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && mix->corner[order[j]] < mix->corner[order[j - 1]]; j--) {
            int swap = order[j];
            order[j] = order[j - 1];
            order[j - 1] = swap;
        }
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += (double)mix->weight[order[i]] * mix->corner[order[i]][k];
        at[k] = sum / (double)UNIT;
    }
}

/* ---- sight by definition ---- */

/* A corner of a part: exact, and rounded. */
typedef struct spot {
    oracle_mix mix;
    double at[3];
} spot;

typedef struct scene {
    const starg_mesh *mesh;
    double largest; /* coordinate */
} scene;

static void minus(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* Sign of orient3d of four points that are off by roundings of coordinates, 0 if not certain. */
static int certain_side(const scene *s, const double *a, const double *b, const double *c,
                        const double *p) {
    double u[3], v[3], w[3], sum = 0, size = 0, wide = 0;
    minus(a, p, u);
    minus(b, p, v);
    minus(c, p, w);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double plus = u[k] * (v[i] * w[j]), less = u[k] * (v[j] * w[i]);
        sum += plus - less;
        size += fabs(plus) + fabs(less);
        wide = fmax(wide, fmax(fabs(u[k]), fmax(fabs(v[k]), fabs(w[k]))));
    }
    double bound = 1e-14 * size + 1e-13 * s->largest * wide * wide + 0x1p-1060 * (1 + wide);
    return (sum > bound) - (sum < -bound);
}

/* Is t certainly on one side of the box of some points? */
static bool boxes_apart(const scene *s, const double *const *points, int count,
                        const double *const t[3]) {
    double slack = 1e-15 * s->largest + 1e-300;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < count; i++) {
            low = fmin(low, points[i][k] - slack);
            high = fmax(high, points[i][k] + slack);
        }
        if ((t[0][k] < low && t[1][k] < low && t[2][k] < low) ||
            (t[0][k] > high && t[1][k] > high && t[2][k] > high))
            return true;
    }
    return false;
}

static bool same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Are all vertices that it is between corners of t? */
static bool holds(const double *const t[3], const oracle_mix *mix) {
    for (int i = 0; i < 3; i++) {
        const double *v = mix->corner[i];
        if (mix->weight[i] != 0 && !same(v, t[0]) && !same(v, t[1]) && !same(v, t[2]))
            return false;
    }
    return true;
}

static bool blocks(const scene *s, const double p[3], const spot *q, const double *const t[3]) {
    const double *ends[2] = {p, q->at};
    if (boxes_apart(s, ends, 2, t))
        return false;
    int side_p = certain_side(s, t[0], t[1], t[2], p);
    if (side_p != 0 && holds(t, &q->mix))
        return false; /* the segment leaves the plane at q */
    int side_q = certain_side(s, t[0], t[1], t[2], q->at);
    if (side_p != 0 && side_p == side_q)
        return false;
    int plus = 0, less = 0;
    for (int i = 0; i < 3; i++) {
        int sign = certain_side(s, q->at, t[i], t[(i + 1) % 3], p);
        plus += sign > 0;
        less += sign < 0;
    }
    if (plus != 0 && less != 0)
        return false; /* the line misses the triangle */
    if ((plus == 3 || less == 3) && side_p != 0 && side_p == -side_q)
        return true;
    return oracle_mix_hidden(p, &q->mix, t);
}

static bool sees_spot(const scene *s, const double p[3], const spot *q) {
    for (size_t f = 0; f < starg_mesh_face_count(s->mesh); f++) {
        const double *t[3];
        corners_of(s->mesh, f, t);
        if (blocks(s, p, q, t))
            return false;
    }
    return true;
}

static bool may_enter(const scene *s, const double p[3], const spot c[3],
                      const double *const t[3]) {
    const double *points[4] = {p, c[0].at, c[1].at, c[2].at}, *const *face = c[0].mix.corner;
    if (boxes_apart(s, points, 4, t))
        return false;
    bool above = false; /* the plane of the part, which is off it only there */
    for (int j = 0; j < 3 && !above; j++)
        above = certain_side(s, face[0], face[1], face[2], t[j]) > 0 ||
                oracle_orient3d(face[0], face[1], face[2], t[j]) > 0;
    if (!above)
        return false;
    for (int i = 0; i < 3; i++) { /* beyond one of the three planes through p */
        int sides = 0;
        for (int j = 0; j < 3; j++)
            sides += certain_side(s, p, c[(i + 1) % 3].at, c[i].at, t[j]) < 0;
        if (sides == 3)
            return false;
    }
    return true;
}

static bool sees_whole(const scene *s, const double p[3], size_t face, const spot c[3]) {
    const oracle_mix mixes[3] = {c[0].mix, c[1].mix, c[2].mix};
    for (size_t f = 0; f < starg_mesh_face_count(s->mesh); f++) {
        const double *t[3];
        corners_of(s->mesh, f, t);
        if (f != face && may_enter(s, p, c, t) && oracle_mixes_entered(p, mixes, t))
            return false;
    }
    return true;
}

/* What a sensor limits. */
typedef struct limits {
    const starg_visibility_options *options;
    const double *direction;
    double planes[4][3];
} limits;

static bool in_view(const limits *l, const double p[3], const double *const v[3],
                    const double at[3]) {
    const starg_visibility_options *o = l->options;
    if ((o->range < INFINITY && oracle_compare_distance(p, at, o->range) > 0) ||
        (o->near > 0 && oracle_compare_distance(p, at, o->near) < 0))
        return false;
    if (o->cone < 360 && oracle_compare_cone(p, l->direction, starg_cone_cosine(o->cone), at) < 0)
        return false;
    for (int i = 0; o->fov[0] > 0 && i < 4; i++)
        if (oracle_compare_plane(p, l->planes[i], at) < 0)
            return false;
    return o->incidence == 0 || oracle_compare_incidence(v[0], v[1], v[2], p, at,
                                                         starg_incidence_cosine(o->incidence)) >= 0;
}

static bool sees_part(const scene *s, const limits *l, const double p[3], const part *own,
                      const spot c[3]) {
    const double *v[3];
    corners_of(s->mesh, own->face, v);
    if (oracle_orient3d(v[0], v[1], v[2], p) <= 0)
        return false;
    for (int k = 0; k < 3; k++)
        if (!in_view(l, p, v, c[k].at))
            return false;
    for (int k = 0; k < 3; k++)
        if (!sees_spot(s, p, &c[k]))
            return false;
    return l->options->face_rule != STARG_FACES_WHOLE || sees_whole(s, p, own->face, c);
}

/* ---- the engines ---- */

/* Do they cut faces into the same parts, in the same order, with the same corners? */
static void check_division(const char *name, const starg_solid *solid, const division *d) {
    const starg_mesh *mesh = solid->mesh;
    if (solid->patches == NULL) { /* none is cut */
        assert_int_equal(d->count, starg_mesh_face_count(mesh));
        return;
    }
    assert_int_equal(d->count, solid_patch_count(solid));
    for (size_t j = 0; j < d->count; j++) {
        assert_int_equal(solid_patch_face(solid, j), d->parts[j].face);
        assert_true(solid->patches->share.data[j] == d->parts[j].share);
        for (size_t k = 0; k < 3; k++) {
            double at[3];
            const double *own = solid_patch_corner(solid, j, k);
            oracle_mix mix = corner_of(mesh, &d->parts[j], (int)k);
            round_corner(&mix, at);
            if (!same(at, own)) {
                print_error("%s: corner %zu of part %zu is at (%.17g, %.17g, %.17g), not at "
                            "(%.17g, %.17g, %.17g)\n",
                            name, k, j, own[0], own[1], own[2], at[0], at[1], at[2]);
                fail();
            }
        }
    }
}

static double length_of(const starg_mesh *mesh) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

static void test_rule(void **state) {
    (void)state;
    starg_context *context = test_context(2);
    for (uint64_t i = 0; i < 40; i++) {
        starg_rng rng = starg_rng_make(71, i, 0);
        shape s = i % 4 == 0 ? shape_tetrahedron() : i % 4 == 1 ? shape_cube(1) : shape_blob(0, i);
        for (size_t k = 0; i % 2 == 1 && k < 3 * s.vertex_count; k++)
            s.vertices[k] += 0.3 * starg_rng_unit(&rng);
        shape_place(&s, 1 + starg_rng_unit(&rng), i % 3 == 0 ? 1e4 * starg_rng_unit(&rng) : 0);
        starg_solid *solid = test_solid_of(context, &s);
        starg_visibility_options view;
        patched_solid patched;
        starg_visibility_options_default(&view);
        view.patch = length_of(solid->mesh) / (2 + (double)starg_rng_below(&rng, 12));
        test_ok(context, patched_solid_make(context, solid, &view, &patched));
        division d = divide_all(solid->mesh, solid->mesh->face_count, view.patch);
        check_division("rule", &patched.solid, &d);
        free(d.parts);
        patched_solid_free(&patched);
        starg_solid_free(solid);
        shape_free(&s);
    }
    test_context_free(context);
}

/* ---- rows ---- */

enum { MOST_POINTS = 64 };

/* Anywhere; with coordinates of different corners; means of two vertices; on the line of a vertex
 * and a corner of a part, of two such corners; in an axis-parallel plane of one; some moved by an
 * ulp. Keeps those inside. */
static size_t pick_points(const starg_solid *solid, const division *d, uint64_t seed, size_t wanted,
                          double (*points)[3]) {
    const starg_mesh *mesh = solid->mesh;
    double lower[3], upper[3];
    size_t count = 0;
    starg_mesh_bounds(mesh, lower, upper);
    for (uint64_t attempt = 0; attempt < 4000 && count < wanted; attempt++) {
        starg_rng rng = starg_rng_make(seed, 4, attempt);
        const double *v = starg_mesh_vertices(mesh);
        const double *a = v + 3 * starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        const double *b = v + 3 * starg_rng_below(&rng, starg_mesh_vertex_count(mesh));
        const part *own = &d->parts[starg_rng_below(&rng, d->count)];
        const part *other = &d->parts[starg_rng_below(&rng, d->count)];
        double at[2][3], *p = points[count], along = (double)starg_rng_below(&rng, 7) / 4 - 0.5;
        for (int i = 0; i < 2; i++) {
            oracle_mix mix = corner_of(mesh, i == 0 ? own : other, (int)starg_rng_below(&rng, 3));
            round_corner(&mix, at[i]);
        }
        for (int k = 0; k < 3; k++) {
            double random = lower[k] + (upper[k] - lower[k]) * starg_rng_unit(&rng);
            double kinds[] = {random,
                              k == 0   ? at[0][0]
                              : k == 1 ? at[1][1]
                                       : 0.5 * (a[2] + at[0][2]),
                              0.5 * (a[k] + b[k]),
                              a[k] + along * (at[0][k] - a[k]),
                              at[0][k] + along * (at[1][k] - at[0][k]),
                              k == (int)(seed % 3) ? at[0][k] : random};
            p[k] = kinds[attempt % 6];
            if (starg_rng_below(&rng, 8) == 0)
                p[k] = nextafter(p[k], starg_rng_below(&rng, 2) ? INFINITY : -INFINITY);
        }
        count += starg_solid_contains(solid, p);
    }
    return count;
}

/* What the row of a point should be: patches in order; of faces that count from either side, with
 * the bits of their backs, others are no targets. */
static void expect_row(const starg_solid *solid, const scene *s, const division *d,
                       const spot *spots, const limits *l, const double p[3], bool *row) {
    size_t targets = starg_space_model_faces(solid), backs = d->count;
    for (size_t j = 0; j < d->count; j++)
        row[j] = sees_part(s, l, p, &d->parts[j], spots + 3 * j);
    for (size_t j = d->count; j-- > 0 && d->parts[j].face >= targets;)
        backs = j;
    for (size_t j = 0, back = backs; solid->space.two_sided && j < backs; j++, back++)
        row[j] = row[j] || row[back];
    for (size_t j = backs; j < d->count; j++)
        row[j] = false;
}

/* Of a soup that counts from either side, the backs have the parts of the fronts: the page says no
 * more than that their points are the same. Here they follow the fronts in their order. */
static void add_backs(const starg_solid *solid, division *d) {
    size_t fronts = starg_space_model_faces(solid), front = 0, count = 0;
    const uint32_t *faces = starg_mesh_faces(solid->mesh);
    if (!solid->space.two_sided)
        return;
    while (front < d->count && d->parts[front].face < fronts)
        front++;
    part *all = malloc(2 * front * sizeof *all);
    assert_non_null(all);
    for (size_t j = 0; j < 2 * front; j++) {
        all[count] = d->parts[j % front];
        all[count].face += j < front ? 0 : fronts;
        for (int i = 0; j >= front && i < 3; i++) { /* weights by the vertices of the back */
            const uint32_t *own = faces + 3 * all[count].face,
                           *first = faces + 3 * d->parts[j - front].face;
            for (int k = 0; k < 3; k++)
                for (int m = 0; m < 3; m++)
                    if (own[m] == first[k])
                        all[count].weight[i][m] = d->parts[j - front].weight[i][k];
        }
        count++;
    }
    free(d->parts);
    *d = (division){count, count, all};
}

/* Returns the number of decisions. */
/* With fewer than three some sensors see nothing. */
static size_t points_per_case(void) {
    size_t rounds = test_rounds(3, MOST_POINTS);
    return rounds > 3 ? rounds : 3;
}

static size_t check_solid(starg_context *context, const char *name, const starg_solid *solid,
                          uint64_t seed, size_t wanted, starg_visibility_options view) {
    patched_solid patched;
    double points[MOST_POINTS][3], directions[MOST_POINTS][3] = {{0}}, largest = 0;
    test_ok(context, patched_solid_make(context, solid, &view, &patched));
    const starg_mesh *mesh = patched.solid.mesh;
    division d = divide_all(mesh, starg_space_model_faces(solid), view.patch);
    add_backs(solid, &d);
    if (!solid->space.two_sided)
        check_division(name, &patched.solid, &d);
    assert_int_equal(d.count, solid_patch_count(&patched.solid));
    for (size_t i = 0; i < 3 * starg_mesh_vertex_count(mesh); i++)
        largest = fmax(largest, fabs(starg_mesh_vertices(mesh)[i]));
    const scene s = {mesh, largest};
    spot *spots = calloc(3 * d.count, sizeof *spots);
    bool *row = malloc(d.count);
    assert_true(spots != NULL && row != NULL);
    for (size_t i = 0; i < 3 * d.count; i++) {
        spots[i].mix = corner_of(mesh, &d.parts[i / 3], (int)(i % 3));
        round_corner(&spots[i].mix, spots[i].at);
    }
    size_t count = pick_points(solid, &d, seed, wanted, points), seen = 0;
    for (size_t i = 0; i < count; i++) {
        starg_rng rng = starg_rng_make(seed, 5, i);
        minus(spots[starg_rng_below(&rng, 3 * d.count)].at, points[i], directions[i]);
    }
    view.directions = directions[0];
    for (int whole = 0; whole < 2; whole++) {
        starg_bits *rows[2];
        view.face_rule = whole ? STARG_FACES_WHOLE : STARG_FACES_VERTICES;
        for (int i = 0; i < 2; i++) {
            view.engine = i == 0 ? STARG_VISIBILITY_GRID : STARG_VISIBILITY_BVH;
            test_ok(context,
                    starg_visibility(context, &patched.solid, points[0], count, &view, &rows[i]));
        }
        for (size_t i = 0; i < count; i++) {
            limits l = {.options = &view, .direction = directions[i]};
            if (view.fov[0] > 0)
                starg_frustum(directions[i], view.up, view.fov, l.planes);
            expect_row(solid, &s, &d, spots, &l, points[i], row);
            for (size_t j = 0; j < d.count; j++) {
                seen += row[j];
                for (int engine = 0; engine < 2; engine++)
                    if (starg_bits_test(rows[engine], i, j) != row[j]) {
                        print_error(
                            "%s, %s, seed %zu, patch %g, whole %d, point %zu (%.17g, %.17g, "
                            "%.17g): part %zu (face %zu) is %d, by definition %d\n",
                            name, engine == 0 ? "grid" : "bvh", (size_t)seed, view.patch, whole, i,
                            points[i][0], points[i][1], points[i][2], j, d.parts[j].face, !row[j],
                            row[j]);
                        fail();
                    }
            }
        }
        starg_bits_free(rows[0]);
        starg_bits_free(rows[1]);
    }
    size_t decisions = 2 * count * d.count;
    print_message("%s: %zu points, %zu parts of %zu faces, %zu of %zu seen\n", name, count, d.count,
                  starg_mesh_face_count(mesh), seen, decisions);
    assert_true(count > 0 && seen > 0);
    free(spots);
    free(row);
    free(d.parts);
    patched_solid_free(&patched);
    return decisions;
}

/* Consumes the shape; parts are at most that share of the diagonal. */
static size_t check_shape(const char *name, shape s, uint64_t seed, double fine,
                          const starg_visibility_options *view) {
    starg_context *context = test_context(2);
    starg_solid *solid = test_solid_of(context, &s);
    starg_visibility_options options;
    starg_visibility_options_default(&options);
    if (view != NULL)
        options = *view;
    options.patch = fine * length_of(solid->mesh);
    size_t decisions = check_solid(context, name, solid, seed, points_per_case(), options);
    starg_solid_free(solid);
    test_context_free(context);
    shape_free(&s);
    return decisions;
}

static void test_lattice(void **state) {
    (void)state;
    check_shape("tetrahedron", shape_tetrahedron(), 1, 0.1, NULL);
    check_shape("cube", shape_cube(1), 2, 0.15, NULL);
    check_shape("room", shape_room(), 3, 0.15, NULL);
    check_shape("columns", shape_columns(), 4, 0.12, NULL);
    check_shape("cavity", shape_cavity(), 5, 0.15, NULL);
}

/* Flat, shaken, far away, tiny and huge. */
static void test_scales(void **state) {
    (void)state;
    bool all = test_rounds(0, 1) == 1; /* else one of the two in each place */
    static const double scales[][2] = {{0.1, 1e6}, {1e-80, 0}, {1e90, 0}, {1e-3, -7e3}};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        if (all || i == 1 || i == 2) {
            shape s = i % 2 == 0 ? shape_room() : shape_cavity();
            shape_place(&s, scales[i][0], scales[i][1]);
            check_shape("placed room", s, 10 + i, 0.17, NULL);
        }
        if (all || i == 0 || i == 3) {
            shape s = shape_blob(1, 60 + i);
            shape_place(&s, scales[i][0], scales[i][1]);
            check_shape("placed blob", s, 20 + i, 0.13, NULL);
        }
    }
    static const double flat[] = {1e-3, 1e-9, 1e-15};
    for (size_t i = 0; i < 3; i++) {
        shape s = shape_blob(1, 40 + i);
        for (size_t v = 0; v < s.vertex_count; v++)
            s.vertices[3 * v + 2] *= flat[i];
        check_shape("flat blob", s, 30 + i, 0.1, NULL);
        s = shape_room();
        for (size_t k = 0; k < 3 * s.vertex_count; k++) {
            starg_rng rng = starg_rng_make(50, i, k);
            s.vertices[k] += flat[i] * (starg_rng_unit(&rng) - 0.5);
        }
        check_shape("shaken room", s, 40 + i, 0.17, NULL);
    }
}

/* Shells within shells, that cross or touch. */
static void test_shells(void **state) {
    (void)state;
    static const double nothing[3] = {0}, offsets[][3] = {{1, 1, 1}, {0.5, 0.25, 0}, {2, 0, 0}};
    shape s = shape_blob(1, 1), inner = shape_blob(0, 2);
    shape_place(&inner, 0.25, 0);
    shape_append(&s, &inner, nothing, 1);
    shape_free(&inner);
    check_shape("nested blobs", s, 50, 0.13, NULL);
    for (size_t i = 0; i < 3; i++) {
        shape other = shape_cube(1);
        s = shape_cube(1);
        shape_place(&s, 2, 0);
        shape_place(&other, 2, 0);
        shape_append(&s, &other, offsets[i], 0);
        shape_free(&other);
        check_shape("two cubes", s, 51 + i, 0.13, NULL);
    }
}

static void test_sensors(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 6; i++) {
        starg_visibility_options view;
        starg_visibility_options_default(&view);
        view.range = i == 0 ? 1.5 : i == 5 ? 3 : INFINITY;
        view.near = i == 0 ? 0.5 : 0;
        view.cone = i == 1 ? 70 : i == 2 ? 180 : 360;
        view.fov[0] = i == 3 ? 90 : i == 5 ? 130 : 0;
        view.fov[1] = i == 3 ? 60 : i == 5 ? 110 : 0;
        view.up[2] = 1;
        view.incidence = i == 4 ? 60 : i == 5 ? 80 : 0;
        check_shape("view in a room", shape_room(), 60 + i, 0.1, &view);
        if (i % 2 == 1)
            check_shape("view among columns", shape_columns(), 70 + i, 0.17, &view);
        check_shape("view in a blob", shape_blob(1, i), 80 + i, 0.13, &view);
    }
}

/* Outside of a solid, beside obstacles, and in a soup of faces that count from one side or both. */
static void test_scenes(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 8; i++) {
        starg_context *context = test_context(2);
        shape s = i % 2 == 0 ? shape_cube(1) : shape_room(), block = shape_cube(1);
        if (i % 2 == 0)
            shape_place(&s, 3, 0);
        for (size_t k = 0; i >= 4 && k < 3 * s.vertex_count; k++)
            s.vertices[k] += 0.2 * starg_rng_unit(&(starg_rng){.state = i + k});
        shape_place(&block, 0.25, 0.375);
        starg_mesh *mesh = test_mesh_of(context, &s), *obstacle = test_mesh_of(context, &block);
        starg_space_options space;
        starg_visibility_options view;
        starg_solid *solid = NULL;
        starg_space_options_default(&space);
        starg_visibility_options_default(&view);
        space.outside = i / 2 == 0;
        space.standoff_most = i / 2 == 0 ? 3 : 0;
        space.soup = i / 2 >= 2;
        space.two_sided = i / 2 == 3;
        test_ok(context, starg_space_create(context, mesh, (const starg_mesh *const[]){obstacle},
                                            i / 2 == 1 || i / 2 == 2, &space, &solid));
        view.patch = 0.15 * length_of(mesh);
        check_solid(context, "scene", solid, 90 + i, points_per_case(), view);
        starg_solid_free(solid);
        starg_mesh_free(mesh);
        starg_mesh_free(obstacle);
        test_context_free(context);
        shape_free(&s);
        shape_free(&block);
    }
}

/* ---- results ---- */

/* Does the verifier refuse the result? */
static void refused(starg_context *context, const char *what, const starg_mesh *mesh,
                    const starg_guards *guards) {
    starg_verdict *verdict = NULL;
    test_ok(context, starg_verify_guards(context, mesh, guards, &verdict));
    if (verdict->passed)
        fail_msg("a result with %s is not refused", what);
    starg_verdict_free(context, verdict);
}

/* What is told of parts, changed one by one. */
static void check_forgeries(starg_context *context, const starg_mesh *mesh, starg_guards *g) {
    double *share = g->partial_share, told = share[0], patch = g->options.visibility.patch;
    share[0] = told * (1 + 1e-6);
    refused(context, "a wrong share", mesh, g);
    share[0] = told;
    g->partial_count--;
    refused(context, "a missing share", mesh, g);
    g->partial_count++;
    g->partial[0]++;
    refused(context, "a share of another face", mesh, g);
    g->partial[0]--;
    g->options.visibility.patch = patch / 2;
    refused(context, "smaller parts", mesh, g);
    g->options.visibility.patch = STARG_PATCH_OFF;
    refused(context, "no parts", mesh, g);
    g->options.visibility.patch = patch;
    g->coverage_area *= 1 - 1e-6;
    refused(context, "less area", mesh, g);
    g->coverage_area /= 1 - 1e-6;
    g->seen_faces[0]++;
    refused(context, "a guard that sees one more face", mesh, g);
    g->seen_faces[0]--;
    g->curve_area[0] *= 1 + 1e-6;
    refused(context, "another curve", mesh, g);
}

/* Cameras in an L, in a T, in two rooms with a door, among columns and among crates. */
static void test_rooms(void **state) {
    (void)state;
    static const char *const plans[][2] = {{"###"
                                            "#  "
                                            "#  ",
                                            "L"},
                                           {"###"
                                            " # "
                                            " # ",
                                            "T"},
                                           {"# #"
                                            "###"
                                            "# #",
                                            "two rooms with a door"}};
    starg_context *context = test_context(2);
    for (size_t i = 0; i < 5; i++) {
        shape s = i == 3   ? shape_columns()
                  : i == 4 ? shape_heap(4, 2)
                           : shape_cells(plans[i][0], 3, 3, 1);
        shape_place(&s, 3, 0);
        starg_solid *solid = test_solid_of(context, &s);
        starg_guard_options options;
        starg_guard_options_default(&options);
        options.candidate_count = 40;
        options.refine = false;
        options.max_guards = 2;
        options.visibility.patch = 1.5;
        options.visibility.range = 4;
        options.visibility.fov[0] = 90;
        options.visibility.fov[1] = 60;
        options.visibility.face_rule = i % 2 == 0 ? STARG_FACES_VERTICES : STARG_FACES_WHOLE;
        starg_guards *guards = test_guard(context, solid, &options);
        assert_true(guards->count == 2 && guards->partial_count > 0);
        check_forgeries(context, starg_solid_mesh(solid), guards);
        starg_guards_free(context, guards);
        starg_solid_free(solid);
        shape_free(&s);
    }
    test_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rule),    cmocka_unit_test(test_lattice),
        cmocka_unit_test(test_scales),  cmocka_unit_test(test_shells),
        cmocka_unit_test(test_sensors), cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_rooms)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
