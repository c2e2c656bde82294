/* SPDX-License-Identifier: Apache-2.0 */
/* Scale and hand of one surface against another: is B a copy of A, how large, and mirrored?
 *
 * Problem: signatures do not depend on scale and reflection, catalogues of parts do. A motion of A,
 * and one of its mirror image, are sought that bring it closest to B; how close tells both apart.
 *
 * Stages:
 * 1. Both surfaces get the centroid 0 and the area 1; the scale is the root of the ratio of areas.
 * 2. For each hand, rotations all over SO(3) [Ale22] are rated by points of A against points of B,
 *    and the best ones improved by a few steps of iterated closest points [BM92].
 * 3. The best of these are improved by points of either surface against the other surface itself.
 *    A step is the rotation and translation that are best for the pairs, by the eigenvector of a
 *    4 x 4 matrix [Horn87].
 * 4. The residual of a hand is the root mean square distance of such points, by the diagonal of A.
 *    The hand is decided if the smaller one is that of a copy and the other is well above it.
 *
 * Invariants: no step makes the residual of its pairs larger. The same seed gives the same numbers.
 * Motions and scaling of A or B change them by rounding and by the choice of points only.
 *
 * Cost: some 200,000 nearest points of a few hundred, and 200,000 of a surface, O(log n) each.
 *
 * [Ale22] Alexa: Super-Fibonacci spirals, CVPR 2022. [BM92] Besl, McKay: A method for registration
 * of 3-D shapes, PAMI 1992. [Horn87] Horn: Closed-form solution of absolute orientation using unit
 * quaternions, JOSA A 1987. */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/rng.h"
#include "core/streams.h"
#include "geometry/bvh.h"
#include "geometry/kd_tree.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"
#include "starguard/shape.h"

static const char STAGE[] = "alignment";

enum {
    POINTS = 600,  /* of a surface */
    ROUGH = 100,   /* the first of them, for stage 2 */
    STARTS = 1000, /* rotations */
    TRIED = 12,    /* of these, improved roughly */
    KEPT = 3,      /* of these, improved with all points */
    ROUGH_STEPS = 12,
    STEPS = 60,
    SWEEPS = 12 /* of Jacobi's method; it converges in half as many */
};
static const double ALIKE = 0.02;   /* residual of a copy at most; above this, shapes differ */
static const double APART = 2;      /* times the other residual, for a hand to be decided, */
static const double LEAST = 0.002;  /* and at least this, */
static const double ROUND = 4;      /* and so many times what triangles leave of what is round */
static const double CREASE = 0.5;   /* cosine between faces that are not of one round surface */
static const double SETTLED = 1e-4; /* relative gain of a step that ends them */

typedef struct side {
    double *vertices; /* centroid 0, area 1; of a mirror image if it is one */
    double *points;   /* POINTS x 3, uniform in area */
    double length;    /* root of the area */
    double diagonal;  /* of its bounding box, by the length */
    double chord;     /* root mean square distance of triangles from a round surface, about */
    bvh *surface;
    kd_tree tree; /* of the points */
} side;

/* q = rotation p + shift */
typedef struct motion {
    double rotation[9], shift[3];
    double residual; /* squared */
} motion;

static void side_free(side *s) {
    RELEASE(s->vertices, s->points);
    bvh_free(s->surface);
    kd_tree_free(&s->tree);
}

/* ---- surfaces ---- */

static double doubled_area(const double *vertices, const uint32_t *face) {
    double u[3], v[3], normal[3];
    for (int k = 0; k < 3; k++) {
        u[k] = vertices[3 * face[1] + k] - vertices[3 * face[0] + k];
        v[k] = vertices[3 * face[2] + k] - vertices[3 * face[0] + k];
    }
    vec3_cross(u, v, normal);
    return sqrt(vec3_dot(normal, normal));
}

/* Divides by the largest extent first, so that no square overflows or vanishes. */
static starg_status normalize(starg_context *context, const starg_mesh *mesh, side *s) {
    const size_t count = starg_mesh_vertex_count(mesh), faces = starg_mesh_face_count(mesh);
    const uint32_t *corners = starg_mesh_faces(mesh);
    double lower[3], upper[3], centre[3] = {0}, sum = 0, extent = 0, diagonal = 0;
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, upper[k] - lower[k]);
    NEW(context, STAGE, s->vertices, 3 * count);
    for (size_t i = 0; extent > 0 && i < 3 * count; i++)
        s->vertices[i] = (starg_mesh_vertices(mesh)[i] - lower[i % 3]) / extent;
    for (size_t f = 0; extent > 0 && f < faces; f++) {
        const double area = doubled_area(s->vertices, corners + 3 * f);
        sum += area;
        for (int k = 0; k < 9; k++)
            centre[k % 3] += area * s->vertices[3 * corners[3 * f + k / 3] + k % 3] / 3;
    }
    if (!(sum > 0))
        return starg_fail(context, STARG_ERROR_MESH, STAGE, "the mesh has no area");
    const double unit = sqrt(sum / 2);
    for (size_t i = 0; i < 3 * count; i++)
        s->vertices[i] = (s->vertices[i] - centre[i % 3] / sum) / unit;
    for (int k = 0; k < 3; k++)
        diagonal += (upper[k] - lower[k]) / extent * ((upper[k] - lower[k]) / extent);
    s->length = extent * unit;
    s->diagonal = sqrt(diagonal) / unit;
    return STARG_OK;
}

/* One point in each of POINTS equal parts of the area. */
static starg_status choose_points(starg_context *context, const starg_mesh *mesh, side *s) {
    const uint32_t *corners = starg_mesh_faces(mesh);
    const size_t faces = starg_mesh_face_count(mesh);
    starg_rng rng = starg_rng_make(context->seed, STREAM_ALIGNMENT, 0);
    double sum = 0;
    size_t face = 0;
    NEW(context, STAGE, s->points, (size_t)3 * POINTS);
    for (size_t i = 0; i < POINTS; i++) {
        const double goal = 2 * ((double)i + starg_rng_unit(&rng)) / POINTS;
        double far = sqrt(starg_rng_unit(&rng)), along = starg_rng_unit(&rng);
        for (double own; face + 1 < faces; face++, sum += own) {
            own = doubled_area(s->vertices, corners + 3 * face);
            if (sum + own > goal)
                break;
        }
        for (int k = 0; k < 3; k++) {
            const double *v = s->vertices + k;
            s->points[3 * i + k] = (1 - far) * v[3 * corners[3 * face]] +
                                   far * ((1 - along) * v[3 * corners[3 * face + 1]] +
                                          along * v[3 * corners[3 * face + 2]]);
        }
    }
    for (size_t i = POINTS - 1; i > 0; i--) { /* so that the first ones are spread evenly, too */
        size_t j = (size_t)starg_rng_below(&rng, i + 1);
        double swap[3];
        memcpy(swap, s->points + 3 * i, sizeof swap);
        memcpy(s->points + 3 * i, s->points + 3 * j, sizeof swap);
        memcpy(s->points + 3 * j, swap, sizeof swap);
    }
    return STARG_OK;
}

/* A normal, as long as twice the area, and the middle. */
static void look_at(const side *s, const uint32_t *face, double normal[3], double middle[3]) {
    const double *a = s->vertices + 3 * face[0], *b = s->vertices + 3 * face[1],
                 *c = s->vertices + 3 * face[2];
    double u[3], v[3];
    vec3_subtract(b, a, u);
    vec3_subtract(c, a, v);
    vec3_cross(u, v, normal);
    for (int k = 0; k < 3; k++)
        middle[k] = (a[k] + b[k] + c[k]) / 3;
}

/* An arc as long as the way between two middles that turns by the angle between the faces is an
 * eighth of both numbers' product off its chord. */
static starg_status measure_chords(starg_context *context, const starg_mesh *mesh, side *s) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    const uint32_t *corners = starg_mesh_faces(mesh);
    double sum = 0;
    TRY(topology_create(context, mesh, &topology));
    for (uint32_t h = 0; h < 3 * starg_mesh_face_count(mesh); h++) {
        double own[3], other[3], from[3], to[3], way[3];
        if (topology->twin[h] == TOPOLOGY_NONE)
            continue;
        look_at(s, corners + h - h % 3, own, from);
        look_at(s, corners + topology->twin[h] - topology->twin[h] % 3, other, to);
        const double area = vec3_length(own), product = area * vec3_length(other);
        const double cosine = product > 0 ? fmin(vec3_dot(own, other) / product, 1) : 0;
        if (cosine < CREASE)
            continue;
        vec3_subtract(to, from, way);
        const double chord = vec3_length(way) * acos(cosine) / 8;
        sum += area / 2 / 3 * chord * chord;
    }
    s->chord = sqrt(sum);
    return STARG_OK;
}

static starg_status prepare(starg_context *context, const starg_mesh *mesh, bool mirrored,
                            side *s) {
    TRY(normalize(context, mesh, s));
    for (size_t i = 0; mirrored && i < starg_mesh_vertex_count(mesh); i++)
        s->vertices[3 * i] = -s->vertices[3 * i];
    TRY(choose_points(context, mesh, s));
    TRY(measure_chords(context, mesh, s));
    TRY(bvh_create(context, s->vertices, starg_mesh_faces(mesh), starg_mesh_face_count(mesh),
                   &s->surface));
    return kd_tree_create(context, s->points, POINTS, 3, &s->tree);
}

/* ---- the best motion of pairs ---- */

/* The eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi's rotations. */
static void largest_eigenvector(double m[4][4], double out[4]) {
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    int best = 0;
    for (int turn = 0; turn < SWEEPS; turn++)
        for (int p = 0; p < 4; p++)
            for (int q = p + 1; q < 4; q++) {
                if (m[p][q] == 0)
                    continue;
                const double half = (m[q][q] - m[p][p]) / (2 * m[p][q]);
                const double t = (half < 0 ? -1 : 1) / (fabs(half) + hypot(half, 1));
                const double c = 1 / hypot(t, 1), s = t * c;
                for (int k = 0; k < 4; k++) {
                    const double a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - s * b;
                    m[k][q] = s * a + c * b;
                }
                for (int k = 0; k < 4; k++) {
                    const double a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - s * b;
                    m[q][k] = s * a + c * b;
                }
                for (int k = 0; k < 4; k++) {
                    const double a = v[k][p], b = v[k][q];
                    v[k][p] = c * a - s * b;
                    v[k][q] = s * a + c * b;
                }
            }
    for (int k = 1; k < 4; k++)
        best = m[k][k] > m[best][best] ? k : best;
    for (int k = 0; k < 4; k++)
        out[k] = v[k][best];
}

static void rotation_of(const double q[4], double r[9]) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double own[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
        2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(r, own, sizeof own);
}

static void apply(const motion *m, const double p[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = vec3_dot(m->rotation + 3 * k, p) + m->shift[k];
}

static void apply_back(const motion *m, const double q[3], double out[3]) {
    double d[3];
    vec3_subtract(q, m->shift, d);
    for (int k = 0; k < 3; k++)
        out[k] = m->rotation[k] * d[0] + m->rotation[3 + k] * d[1] + m->rotation[6 + k] * d[2];
}

/* Sums over pairs (p, q). */
typedef struct sums {
    double p[3], q[3], products[3][3], squared;
    size_t count;
} sums;

static void add_pair(sums *s, const double p[3], const double q[3], double squared) {
    for (int i = 0; i < 3; i++) {
        s->p[i] += p[i];
        s->q[i] += q[i];
        for (int k = 0; k < 3; k++)
            s->products[i][k] += p[i] * q[k];
    }
    s->squared += squared;
    s->count++;
}

static void solve(const sums *s, motion *m) {
    double c[3][3], q[4], turned[3];
    const double n = (double)s->count;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            c[i][k] = s->products[i][k] - s->p[i] * s->q[k] / n;
    double horn[4][4] = {
        {c[0][0] + c[1][1] + c[2][2], c[1][2] - c[2][1], c[2][0] - c[0][2], c[0][1] - c[1][0]},
        {c[1][2] - c[2][1], c[0][0] - c[1][1] - c[2][2], c[0][1] + c[1][0], c[2][0] + c[0][2]},
        {c[2][0] - c[0][2], c[0][1] + c[1][0], c[1][1] - c[0][0] - c[2][2], c[1][2] + c[2][1]},
        {c[0][1] - c[1][0], c[2][0] + c[0][2], c[1][2] + c[2][1], c[2][2] - c[0][0] - c[1][1]}};
    largest_eigenvector(horn, q);
    rotation_of(q, m->rotation);
    for (int k = 0; k < 3; k++)
        turned[k] = vec3_dot(m->rotation + 3 * k, s->p) / n;
    for (int k = 0; k < 3; k++)
        m->shift[k] = s->q[k] / n - turned[k];
}

/* ---- iterated closest points ---- */

/* Points of A against the points of B. */
static void pair_roughly(const side *a, const side *b, const motion *m, sums *out) {
    *out = (sums){0};
    for (size_t i = 0; i < ROUGH; i++) {
        double at[3], squared;
        apply(m, a->points + 3 * i, at);
        size_t j = kd_tree_nearest(&b->tree, at, &squared);
        add_pair(out, a->points + 3 * i, b->points + 3 * j, squared);
    }
}

/* Points of either surface against the other one. */
static void pair_all(const side *a, const side *b, const motion *m, sums *out) {
    *out = (sums){0};
    for (size_t i = 0; i < POINTS; i++) {
        double at[3], near[3], d[3];
        apply(m, a->points + 3 * i, at);
        bvh_nearest(b->surface, at, near);
        vec3_subtract(near, at, d);
        add_pair(out, a->points + 3 * i, near, vec3_dot(d, d));
        apply_back(m, b->points + 3 * i, at);
        bvh_nearest(a->surface, at, near);
        vec3_subtract(near, at, d);
        add_pair(out, near, b->points + 3 * i, vec3_dot(d, d));
    }
}

static void improve(const side *a, const side *b, bool rough, motion *m) {
    double before = INFINITY;
    for (int step = 0;; step++) {
        sums found;
        (rough ? pair_roughly : pair_all)(a, b, m, &found);
        m->residual = found.squared / (double)found.count;
        if (step == (rough ? ROUGH_STEPS : STEPS) || !(m->residual < (1 - SETTLED) * before))
            return;
        before = m->residual;
        solve(&found, m);
    }
}

static void start(size_t i, motion *m) {
    static const double ROOT = 1.4142135623730951, OTHER = 1.533751168755204288;
    const double s = (double)i + 0.5, r = sqrt(s / STARTS), rest = sqrt(1 - s / STARTS);
    const double alpha = 6.283185307179586 * s / ROOT, beta = 6.283185307179586 * s / OTHER;
    rotation_of((double[4]){r * sin(alpha), r * cos(alpha), rest * sin(beta), rest * cos(beta)},
                m->rotation);
    memset(m->shift, 0, sizeof m->shift);
}

/* Puts m into a list of the `most` best ones, ascending. */
static void rank(motion *list, size_t *count, size_t most, const motion *m) {
    size_t at = *count;
    while (at > 0 && list[at - 1].residual > m->residual)
        at--;
    if (at == most)
        return;
    *count += *count < most;
    memmove(list + at + 1, list + at, (*count - at - 1) * sizeof *list);
    list[at] = *m;
}

/* The least root mean square distance over all motions of A, as far as is found. */
static starg_status align(starg_context *context, const side *a, const side *b, double *residual) {
    motion tried[TRIED], kept[KEPT], m;
    size_t tries = 0, count = 0;
    sums found;
    for (size_t i = 0; i < STARTS; i++) {
        start(i, &m);
        pair_roughly(a, b, &m, &found);
        m.residual = found.squared;
        rank(tried, &tries, TRIED, &m);
    }
    for (size_t i = 0; i < tries; i++) {
        improve(a, b, true, &tried[i]);
        rank(kept, &count, KEPT, &tried[i]);
    }
    *residual = INFINITY;
    for (size_t i = 0; i < count; i++) {
        TRY(starg_check_cancel(context, STAGE));
        improve(a, b, false, &kept[i]);
        *residual = fmin(*residual, sqrt(kept[i].residual) / a->diagonal);
    }
    return STARG_OK;
}

/* ---- the call ---- */

static starg_hand decide(double same, double mirrored, double chord) {
    const double least = fmin(same, mirrored), most = fmax(same, mirrored);
    if (least > ALIKE || most < fmax(LEAST, ROUND * chord) || most < APART * least)
        return STARG_HAND_UNDECIDED;
    return same < mirrored ? STARG_HAND_SAME : STARG_HAND_MIRRORED;
}

starg_status starg_alignment_measure(starg_context *context, const starg_mesh *a,
                                     const starg_mesh *b, starg_alignment *out) {
    starg_status status = STARG_OK;
    side sides[3] = {{0}}; /* A, its mirror image, B */
    *out = (starg_alignment){.hand = STARG_HAND_UNDECIDED};
    for (int i = 0; i < 3 && status == STARG_OK; i++)
        status = prepare(context, i < 2 ? a : b, i == 1, &sides[i]);
    if (status == STARG_OK)
        status = align(context, &sides[0], &sides[2], &out->same);
    if (status == STARG_OK)
        status = align(context, &sides[1], &sides[2], &out->mirrored);
    if (status == STARG_OK) {
        const double chord = fmax(sides[0].chord, sides[2].chord) / sides[0].diagonal;
        out->scale = sides[2].length / sides[0].length;
        out->hand = decide(out->same, out->mirrored, chord);
    }
    for (int i = 0; i < 3; i++)
        side_free(&sides[i]);
    return status;
}

const char *starg_hand_name(starg_hand hand) {
    static const char *const names[] = {"same", "mirrored", "undecided"};
    return (unsigned)hand < sizeof names / sizeof *names ? names[hand] : NULL;
}
