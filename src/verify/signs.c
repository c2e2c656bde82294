/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/signs.h"

#include <math.h>

static bool same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* ---- signs ----
 *
 * Filter: differences and products in doubles have a relative error below 8 x 2^-53 of the sum of
 * the absolute products, so 1e-14 of it is safe; products that underflow lose less than 1e-220, far
 * below the constant term. */

#define ROUNDING  1e-14
#define UNDERFLOW 1e-200

static int exact_side(const double a[3], const double b[3], const double c[3], const double p[3]) {
    exact_sum sum;
    exact_sum_clear(&sum);
    exact_sum_add_determinant(&sum, a, b, c);
    exact_sum_add_determinant(&sum, b, a, p);
    exact_sum_add_determinant(&sum, a, c, p);
    exact_sum_add_determinant(&sum, c, b, p);
    return exact_sum_sign(&sum);
}

/* The common causes of a zero: p is a corner, or all four are in an axis-aligned plane. */
static bool plainly_flat(const double a[3], const double b[3], const double c[3],
                         const double p[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] == p[k] && b[k] == p[k] && c[k] == p[k])
            return true;
    return same(p, a) || same(p, b) || same(p, c);
}

int verify_side(const double a[3], const double b[3], const double c[3], const double p[3]) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) {
        u[k] = a[k] - p[k];
        v[k] = b[k] - p[k];
        w[k] = c[k] - p[k];
    }
    double sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        double plus = u[k] * (v[(k + 1) % 3] * w[(k + 2) % 3]);
        double minus = u[k] * (v[(k + 2) % 3] * w[(k + 1) % 3]);
        sum += plus - minus;
        size += fabs(plus) + fabs(minus);
    }
    double bound = ROUNDING * size + UNDERFLOW;
    if (sum > bound)
        return 1;
    if (sum < -bound)
        return -1;
    return plainly_flat(a, b, c, p) ? 0 : exact_side(a, b, c, p);
}

/* a x b + b x c + c x a in the plane of u and v */
static int exact_turn(const double a[3], const double b[3], const double c[3], int u, int v) {
    const double *corner[3] = {a, b, c};
    exact_sum sum;
    exact_sum_clear(&sum);
    for (int i = 0; i < 3; i++) {
        const double *x = corner[i], *y = corner[(i + 1) % 3];
        exact_sum_add(&sum, x[u], y[v], 1);
        exact_sum_add(&sum, -x[v], y[u], 1);
    }
    return exact_sum_sign(&sum);
}

int verify_turn(const double a[3], const double b[3], const double c[3], int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double plus = (b[u] - a[u]) * (c[v] - a[v]), minus = (b[v] - a[v]) * (c[u] - a[u]);
    double bound = ROUNDING * (fabs(plus) + fabs(minus)) + UNDERFLOW;
    if (plus - minus > bound)
        return 1;
    return plus - minus < -bound ? -1 : exact_turn(a, b, c, u, v);
}

/* Sign of radius - |p - q|. */
static int compare_radius(const double p[3], const double q[3], double radius) {
    if (radius >= 1e101)
        return 1; /* farther than any two points below 1e100 */
    double squared = 0, limit = radius * radius;
    for (int k = 0; k < 3; k++)
        squared += (p[k] - q[k]) * (p[k] - q[k]);
    double bound = ROUNDING * (squared + limit) + UNDERFLOW;
    if (fabs(limit - squared) > bound)
        return limit > squared ? 1 : -1;
    exact_sum sum; /* r^2 - sum of (p - q)^2 */
    exact_sum_clear(&sum);
    exact_sum_add(&sum, radius, radius, 1);
    for (int k = 0; k < 3; k++) {
        exact_sum_add(&sum, -p[k], p[k], 1);
        exact_sum_add(&sum, 2 * p[k], q[k], 1);
        exact_sum_add(&sum, -q[k], q[k], 1);
    }
    return exact_sum_sign(&sum);
}

bool verify_within(const double p[3], const double q[3], double radius) {
    return compare_radius(p, q, radius) >= 0;
}

bool verify_nearer(const double p[3], const double q[3], double radius) {
    return compare_radius(p, q, radius) > 0;
}

/* ---- points and segments ---- */

static bool between(double x, double a, double b) {
    return (a <= x && x <= b) || (b <= x && x <= a);
}

static bool on_segment(const double p[3], const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++)
        if (!between(p[k], a[k], b[k]) || verify_turn(p, a, b, k) != 0)
            return false;
    return true;
}

bool verify_on_triangle(const double p[3], const double *const t[3]) {
    if (verify_side(t[0], t[1], t[2], p) != 0)
        return false;
    for (int axis = 0; axis < 3; axis++) {
        int turn = verify_turn(t[0], t[1], t[2], axis);
        if (turn != 0) /* in this projection the triangle has area */
            return verify_turn(t[0], t[1], p, axis) * turn >= 0 &&
                   verify_turn(t[1], t[2], p, axis) * turn >= 0 &&
                   verify_turn(t[2], t[0], p, axis) * turn >= 0;
    }
    return on_segment(p, t[0], t[1]) || on_segment(p, t[1], t[2]) || on_segment(p, t[2], t[0]);
}

/* [p, q) and [a, b] on one line. */
static bool meet_on_line(const double p[3], const double q[3], const double a[3],
                         const double b[3]) {
    for (int k = 0; k < 3; k++) {
        if (p[k] == q[k])
            continue;
        double low = fmin(a[k], b[k]),
               high = fmax(a[k], b[k]); /* the order along k is that on the line */
        return p[k] < q[k] ? low < q[k] && high >= p[k] : high > q[k] && low <= p[k];
    }
    return false; /* p is q */
}

/* Does [p, q) meet [a, b], on which p does not lie? */
static bool blocked_by_segment(const double p[3], const double q[3], const double a[3],
                               const double b[3]) {
    if (verify_side(p, q, a, b) != 0)
        return false;
    for (int axis = 0; axis < 3; axis++) {
        int a_side = verify_turn(p, q, a, axis), b_side = verify_turn(p, q, b, axis);
        int p_side = verify_turn(a, b, p, axis), q_side = verify_turn(a, b, q, axis);
        if (a_side == 0 && b_side == 0 && p_side == 0 && q_side == 0)
            continue; /* their plane is seen edge-on */
        /* On different lines that meet in one point, which is q if q is on the other line. */
        return a_side * b_side <= 0 && p_side * q_side < 0;
    }
    return meet_on_line(p, q, a, b);
}

/* Does the line p q, which is not in the plane of t, pass through t or its boundary? */
static bool line_meets(const double p[3], const double q[3], const double *const t[3]) {
    int plus = 0, minus = 0;
    for (int i = 0; i < 3; i++) {
        int side = verify_side(p, q, t[i], t[(i + 1) % 3]);
        plus += side > 0;
        minus += side < 0;
    }
    return plus == 0 || minus == 0;
}

/* Are the bounds of some points and of t disjoint? */
static bool bounds_apart(const double *const *points, int count, const double *const t[3]) {
    for (int k = 0; k < 3; k++) {
        double low = points[0][k], high = points[0][k];
        for (int i = 1; i < count; i++) {
            low = points[i][k] < low ? points[i][k] : low;
            high = points[i][k] > high ? points[i][k] : high;
        }
        if ((t[0][k] < low && t[1][k] < low && t[2][k] < low) ||
            (t[0][k] > high && t[1][k] > high && t[2][k] > high))
            return true;
    }
    return false;
}

/* Does [p, q) meet t, if their bounds meet and p is on that side of t? */
static bool blocks_near(int p_side, const double p[3], const double q[3],
                        const double *const t[3]) {
    int q_side = verify_side(t[0], t[1], t[2], q);
    if (p_side != 0) /* then t has area; ending in its plane at q is no contact */
        return p_side * q_side < 0 && line_meets(p, q, t);
    if (q_side != 0)
        return false; /* the segment meets the plane only at p, which is not on t */
    /* All coplanar, or t without area: from p, off t, a segment reaches t only through an edge. */
    return blocked_by_segment(p, q, t[0], t[1]) || blocked_by_segment(p, q, t[1], t[2]) ||
           blocked_by_segment(p, q, t[2], t[0]);
}

bool verify_blocks(const double p[3], const double q[3], const double *const t[3]) {
    const double *ends[2] = {p, q};
    return !bounds_apart(ends, 2, t) && blocks_near(verify_side(t[0], t[1], t[2], p), p, q, t);
}

bool verify_blocks_from(int p_side, const double p[3], const double q[3],
                        const double *const t[3]) {
    const double *ends[2] = {p, q};
    return !bounds_apart(ends, 2, t) && blocks_near(p_side, p, q, t);
}

/* ---- triangles ----
 *
 * The intersection of t and the tetrahedron is the hull of points each of which is a corner of t in
 * the tetrahedron, or where an edge of t meets a side of it, or where an edge of it meets t. Off
 * the face, edges of the tetrahedron are the segments from p to its corners, which t does not
 * block; so there remains a corner of t in the tetrahedron off the face, or an edge of t that
 * passes through the interior of one of the three sides at p. */

bool verify_enters(const double p[3], const double *const face[3], const double *const t[3]) {
    const double *corners[4] = {p, face[0], face[1], face[2]};
    int side[3][3], height[3];
    if (bounds_apart(corners, 4, t))
        return false;
    for (int j = 0; j < 3; j++)
        height[j] = verify_side(face[0], face[1], face[2], t[j]);
    if (height[0] <= 0 && height[1] <= 0 && height[2] <= 0)
        return false;
    for (int i = 0; i < 3; i++) {
        const double *from = face[i], *to = face[(i + 1) % 3];
        for (int j = 0; j < 3; j++)
            side[i][j] = verify_side(to, from, p, t[j]);
        if (side[i][0] < 0 && side[i][1] < 0 && side[i][2] < 0)
            return false;
    }
    for (int j = 0; j < 3; j++)
        if (height[j] > 0 && side[0][j] >= 0 && side[1][j] >= 0 && side[2][j] >= 0)
            return true;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double *u = t[j], *v = t[(j + 1) % 3];
            if (side[i][j] * side[i][(j + 1) % 3] >= 0)
                continue;
            int turn = verify_side(u, v, p, face[i]);
            if (turn != 0 && verify_side(u, v, face[i], face[(i + 1) % 3]) == turn &&
                verify_side(u, v, face[(i + 1) % 3], p) == turn)
                return true;
        }
    return false;
}

static bool edge_passes(const double *const s[3], const double *const t[3]) {
    int side[3];
    for (int i = 0; i < 3; i++)
        side[i] = verify_side(t[0], t[1], t[2], s[i]);
    for (int i = 0; i < 3; i++)
        if (side[i] * side[(i + 1) % 3] < 0 && line_meets(s[i], s[(i + 1) % 3], t))
            return true;
    return false;
}

/* Coplanar triangles overlap unless a line along an edge of one separates them. */
static bool overlap(const double *const s[3], const double *const t[3]) {
    int axis = 0;
    while (axis < 3 && verify_turn(s[0], s[1], s[2], axis) == 0)
        axis++;
    if (axis == 3 || verify_turn(t[0], t[1], t[2], axis) == 0)
        return false; /* no area */
    const double *const *pair[2] = {s, t};
    for (int i = 0; i < 6; i++) {
        const double *const *own = pair[i / 3], *const *other = pair[1 - i / 3];
        const double *a = own[i % 3], *b = own[(i + 1) % 3];
        int inside = verify_turn(own[0], own[1], own[2], axis);
        if (verify_turn(a, b, other[0], axis) * inside <= 0 &&
            verify_turn(a, b, other[1], axis) * inside <= 0 &&
            verify_turn(a, b, other[2], axis) * inside <= 0)
            return false;
    }
    return true;
}

bool verify_cross(const double *const s[3], const double *const t[3]) {
    if (edge_passes(s, t) || edge_passes(t, s))
        return true;
    for (int i = 0; i < 3; i++)
        if (verify_side(s[0], s[1], s[2], t[i]) != 0 || verify_side(t[0], t[1], t[2], s[i]) != 0)
            return false;
    return overlap(s, t);
}
