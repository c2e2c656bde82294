/* SPDX-License-Identifier: Apache-2.0 */
/* Signs of points between vertices.
 *
 * A rounded coordinate is a sum of three products times a power of two: five roundings, each below
 * 2^-53 times the largest coordinate m of the corners, so that it is off by at most blur = 8 x
 * 2^-53 m. A determinant of three rows of differences, which are at most r, then changes by less
 * than 3 rows x 3 entries x 2 blur x 2 r^2 (1 + 2 blur / r)^2: 40 blur (r + 2 blur)^2. Its own
 * rounding error is below 8 x 2^-53 x 6 r^3 (geometry/predicates.c).
 *
 * Cost: about 10 ns where the filter decides, 1 to 5 us in integers. */
#include "geometry/dyadic.h"

#include <math.h>

#include "geometry/exact.h"
#include "geometry/intersect.h"
#include "geometry/predicates.h"

static const double EPSILON = 0x1p-53;

/* Underflow is not covered by the bounds: below this integers decide. */
static const double TINY_2 = 1e-250, TINY_3 = 1e-200;

/* Products and sums above this keep all their bits when they are halved DYADIC_DEPTH times. */
static const double TINY_PRODUCT = 0x1p-900;

enum { MOST_VALUES = 4 * 3 };

static int sign_of(double x) {
    return (x > 0) - (x < 0);
}

/* The doubles that make up coordinate k of a point; returns how many. */
static size_t list_values(const dyadic_point *p, int k, double values[3]) {
    size_t count = 0;
    if (p->exact) {
        values[0] = p->at[k];
        return 1;
    }
    for (int i = 0; i < 3; i++)
        if (p->weight[i] > 0)
            values[count++] = p->corner[i][k];
    return count;
}

static void add_product(exact *sum, double value, int scale, double factor) {
    exact x, y, product, before = *sum;
    exact_set(&x, value, scale);
    exact_set(&y, factor, 0);
    exact_multiply(&product, &x, &y);
    exact_add(sum, &before, &product);
}

/* out = 2^depth times coordinate k, in units of 2^scale. */
static void scaled_coordinate(exact *out, const dyadic_point *p, int k, int depth, int scale) {
    *out = (exact){.sign = 0, .count = 0};
    if (p->exact) {
        add_product(out, p->at[k], scale, ldexp(1, depth));
        return;
    }
    for (int i = 0; i < 3; i++)
        if (p->weight[i] > 0)
            add_product(out, p->corner[i][k], scale, ldexp(p->weight[i], depth - p->depth));
}

/* The common scale of some coordinates of some points, and their largest depth. */
static int common_scale(const dyadic_point *const *points, int count, int axes, int first,
                        int *depth) {
    double values[3 * MOST_VALUES];
    size_t used = 0;
    int bits;
    *depth = 0;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < axes; k++)
            used += list_values(points[i], (first + k) % 3, values + used);
        if (!points[i]->exact && points[i]->depth > *depth)
            *depth = points[i]->depth;
    }
    return exact_scale(values, used, &bits);
}

/* *sum += weight * value; is the result exact? */
static bool add_exactly(double *sum, double weight, double value) {
    double product = weight * value, before = *sum;
    *sum = before + product;
    double added = *sum - before;
    bool tiny = product != 0 && fabs(product) < TINY_PRODUCT;
    return !tiny && fma(weight, value, -product) == 0 && before - (*sum - added) == 0 &&
           product - added == 0;
}

void dyadic_round(dyadic_point *p) {
    double most = 0;
    p->exact = true;
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            if (p->weight[i] > 0) {
                p->exact = add_exactly(&sum, p->weight[i], p->corner[i][k]) && p->exact;
                most = fmax(most, fabs(p->corner[i][k]));
            }
        p->at[k] = ldexp(sum, -p->depth);
        p->exact = p->exact && (sum == 0 || fabs(sum) > TINY_PRODUCT);
    }
    p->blur = p->exact ? 0 : dyadic_blur(most);
}

/* Sign of a[k] - b[k]. */
static int compare(const dyadic_point *a, const dyadic_point *b, int k) {
    double difference = a->at[k] - b->at[k];
    const dyadic_point *points[2] = {a, b};
    exact x, y, d;
    int depth;
    if (a->exact && b->exact)
        return sign_of(difference);
    if (fabs(difference) > 2 * (a->blur + b->blur) && a->blur + b->blur > 0)
        return sign_of(difference);
    int scale = common_scale(points, 2, 1, k, &depth);
    scaled_coordinate(&x, a, k, depth, scale);
    scaled_coordinate(&y, b, k, depth, scale);
    exact_subtract(&d, &x, &y);
    return d.sign;
}

/* ---- signs by vertices ----
 *
 * A determinant is linear in each point, so it is a sum over vertices with the weights as factors.
 * If its terms have one sign, or vanish, that is its sign; no integers are needed. So it is with
 * points on an edge and the planes and lines through that edge. */

enum { NEGATIVE = 1, POSITIVE = 2, MIXED = NEGATIVE | POSITIVE };

static int mark_of(int sign) {
    return sign > 0 ? POSITIVE : sign < 0 ? NEGATIVE : 0;
}

static bool is_at(const double *a, const double *b) {
    return a == b || (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
}

/* The vertices of two points, with the weights of both. */
typedef struct vertex_pair {
    const double *at[6];
    int64_t weight[6][2];
    int count;
} vertex_pair;

static void add_vertex(vertex_pair *v, const double *at, int which, uint32_t weight) {
    int i = 0;
    while (i < v->count && !is_at(v->at[i], at))
        i++;
    if (i == v->count) {
        v->at[i] = at;
        v->weight[i][0] = v->weight[i][1] = 0;
        v->count++;
    }
    v->weight[i][which] += weight;
}

static void add_vertices(vertex_pair *v, const dyadic_point *p, int which) {
    if (p->exact)
        add_vertex(v, p->at, which, 1);
    for (int i = 0; i < 3 && !p->exact; i++)
        if (p->weight[i] > 0)
            add_vertex(v, p->corner[i], which, p->weight[i]);
}

/* Of points i and j by their vertices, the others being exact: the sum over pairs of vertices of
 * (w_k w'_l - w_l w'_k) orient3d. MIXED is not decided. */
static int orient3d_by_vertices(const dyadic_point *const points[4], int i, int j) {
    const double *at[4];
    vertex_pair v = {.count = 0};
    int found = 0;
    for (int k = 0; k < 4; k++)
        at[k] = points[k]->at;
    add_vertices(&v, points[i], 0);
    add_vertices(&v, points[j], 1);
    for (int k = 0; k < v.count && found != MIXED; k++)
        for (int l = k + 1; l < v.count && found != MIXED; l++) {
            int64_t minor = v.weight[k][0] * v.weight[l][1] - v.weight[l][0] * v.weight[k][1];
            if (minor == 0)
                continue;
            at[i] = v.at[k];
            at[j] = v.at[l];
            found |= mark_of((minor > 0 ? 1 : -1) * orient3d(at[0], at[1], at[2], at[3]));
        }
    return found;
}

/* The sign of orient3d in *sign, if vertices tell it: of one or two points that are not exact. */
static bool vertices_tell(const dyadic_point *const points[4], int *sign) {
    int inexact[4], count = 0, other = 0;
    for (int k = 0; k < 4; k++)
        if (points[k]->exact)
            other = k;
        else
            inexact[count++] = k;
    if (count > 2)
        return false;
    int found = orient3d_by_vertices(points, inexact[0], count == 2 ? inexact[1] : other);
    *sign = (found == POSITIVE) - (found == NEGATIVE);
    return found != MIXED;
}

/* The same of orient2d, of one point that is not exact. */
static bool vertices_tell_2d(const dyadic_point *const points[3], int u, int v, int *sign) {
    const double *at[3];
    int which = -1, found = 0;
    for (int k = 0; k < 3; k++) {
        at[k] = points[k]->at;
        if (points[k]->exact)
            continue;
        if (which >= 0)
            return false;
        which = k;
    }
    for (int i = 0; i < 3; i++)
        if (points[which]->weight[i] > 0) {
            at[which] = points[which]->corner[i];
            found |= mark_of(orient2d(at[0], at[1], at[2], u, v));
        }
    *sign = (found == POSITIVE) - (found == NEGATIVE);
    return found != MIXED;
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

static double largest_blur(const dyadic_point *const *points, int count) {
    double blur = 0;
    for (int i = 0; i < count; i++)
        blur = larger(blur, points[i]->blur);
    return blur;
}

static __attribute__((noinline)) int orient3d_in_integers(const dyadic_point *const points[4]) {
    exact corner[4][3], row[3][3], determinant;
    int depth, scale = common_scale(points, 4, 3, 0, &depth);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            scaled_coordinate(&corner[i][k], points[i], k, depth, scale);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            exact_subtract(&row[i][k], &corner[i][k], &corner[3][k]);
    exact_determinant(&determinant, row[0], row[1], row[2]);
    return determinant.sign;
}

int dyadic_orient3d(const dyadic_point *a, const dyadic_point *b, const dyadic_point *c,
                    const dyadic_point *d) {
    const dyadic_point *const points[4] = {a, b, c, d};
    double m[3][3], reach = 0, blur = largest_blur(points, 4);
    if (a->exact && b->exact && c->exact && d->exact)
        return orient3d(a->at, b->at, c->at, d->at);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            m[i][k] = points[i]->at[k] - d->at[k];
            reach = larger(reach, fabs(m[i][k]));
        }
    double determinant = m[0][2] * (m[1][0] * m[2][1] - m[2][0] * m[1][1]) +
                         m[1][2] * (m[2][0] * m[0][1] - m[0][0] * m[2][1]) +
                         m[2][2] * (m[0][0] * m[1][1] - m[1][0] * m[0][1]);
    double wide = reach + 2 * blur;
    double bound = 48 * EPSILON * reach * reach * reach + 40 * blur * wide * wide;
    if (bound > TINY_3 && fabs(determinant) > bound)
        return sign_of(determinant);
    int sign;
    return vertices_tell(points, &sign) ? sign : orient3d_in_integers(points);
}

static __attribute__((noinline)) int orient2d_in_integers(const dyadic_point *const points[3],
                                                          int u, int v) {
    exact corner[3][2], row[2][2], determinant;
    const int axis[2] = {u, v};
    int depth, scale = common_scale(points, 3, 3, 0, &depth);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            scaled_coordinate(&corner[i][k], points[i], axis[k], depth, scale);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++)
            exact_subtract(&row[i][k], &corner[i][k], &corner[2][k]);
    exact_minor(&determinant, &row[0][0], &row[1][1], &row[0][1], &row[1][0]);
    return determinant.sign;
}

static int orient2d_of(const dyadic_point *a, const dyadic_point *b, const dyadic_point *c, int u,
                       int v) {
    const dyadic_point *const points[3] = {a, b, c};
    double blur = largest_blur(points, 3);
    if (a->exact && b->exact && c->exact)
        return orient2d(a->at, b->at, c->at, u, v);
    double au = a->at[u] - c->at[u], av = a->at[v] - c->at[v];
    double bu = b->at[u] - c->at[u], bv = b->at[v] - c->at[v];
    double reach = larger(larger(fabs(au), fabs(av)), larger(fabs(bu), fabs(bv)));
    double determinant = au * bv - av * bu;
    double bound = 8 * EPSILON * reach * reach + 10 * blur * (reach + 2 * blur);
    if (bound > TINY_2 && fabs(determinant) > bound)
        return sign_of(determinant);
    int sign;
    return vertices_tell_2d(points, u, v, &sign) ? sign : orient2d_in_integers(points, u, v);
}

static bool aligned(const dyadic_point *a, const dyadic_point *b, const dyadic_point *c) {
    return orient2d_of(a, b, c, 0, 1) == 0 && orient2d_of(a, b, c, 1, 2) == 0 &&
           orient2d_of(a, b, c, 2, 0) == 0;
}

#define POINT                const dyadic_point *
#define TURN3(a, b, c, d)    dyadic_orient3d(a, b, c, d)
#define TURN2(a, b, c, u, v) orient2d_of(a, b, c, u, v)
#define ORDER(a, b, k)       compare(a, b, k)
#define ALIGNED(a, b, c)     aligned(a, b, c)
#include "geometry/segment_stages.h"

bool dyadic_segment_meets_triangle(const double p[3], const dyadic_point *q, const double a[3],
                                   const double b[3], const double c[3]) {
    if (q->exact)
        return segment_meets_triangle(p, q->at, a, b, c);
    const dyadic_point from = dyadic_of(p), t[3] = {dyadic_of(a), dyadic_of(b), dyadic_of(c)};
    return half_open_meets_triangle(&from, q, &t[0], &t[1], &t[2]);
}
