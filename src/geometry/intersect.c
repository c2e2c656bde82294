/* SPDX-License-Identifier: Apache-2.0 */
/* Intersection tests by predicates only, without constructing points: coplanar cases are decided in
 * a coordinate plane onto which the common plane projects injectively, and triangles without area
 * are treated as their edges. */
#include "geometry/intersect.h"

#include "geometry/predicates.h"

static bool same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool between(double x, double a, double b) {
    return (a <= x && x <= b) || (b <= x && x <= a);
}

static bool in_box_of(const double p[3], const double a[3], const double b[3]) {
    return between(p[0], a[0], b[0]) && between(p[1], a[1], b[1]) && between(p[2], a[2], b[2]);
}

static bool point_on_segment(const double p[3], const double a[3], const double b[3]) {
    return in_box_of(p, a, b) && collinear(a, b, p);
}

/* Finds a coordinate plane (u, v) in which a, b, c have area; returns their turn there, or 0. */
static int turn_in_plane(const double a[3], const double b[3], const double c[3], int *u, int *v) {
    for (int k = 0; k < 3; k++) {
        *u = k;
        *v = (k + 1) % 3;
        int turn = orient2d(a, b, c, *u, *v);
        if (turn != 0)
            return turn;
    }
    return 0;
}

/* Closed segments whose four endpoints are coplanar but not all collinear. */
static bool segments_meet_in_plane(const double a[3], const double b[3], const double c[3],
                                   const double d[3], int u, int v) {
    return orient2d(a, b, c, u, v) * orient2d(a, b, d, u, v) <= 0 &&
           orient2d(c, d, a, u, v) * orient2d(c, d, b, u, v) <= 0;
}

bool segments_meet(const double a[3], const double b[3], const double c[3], const double d[3]) {
    if (same(a, b))
        return point_on_segment(a, c, d);
    if (same(c, d))
        return point_on_segment(c, a, b);
    if (orient3d(a, b, c, d) != 0)
        return false;
    int u, v;
    if (turn_in_plane(a, b, c, &u, &v) != 0 || turn_in_plane(a, b, d, &u, &v) != 0)
        return segments_meet_in_plane(a, b, c, d, u, v);
    return in_box_of(c, a, b) || in_box_of(d, a, b) || in_box_of(a, c, d);
}

bool point_on_triangle(const double p[3], const double a[3], const double b[3], const double c[3]) {
    if (orient3d(a, b, c, p) != 0)
        return false;
    int u, v, turn = turn_in_plane(a, b, c, &u, &v);
    if (turn == 0)
        return point_on_segment(p, a, b) || point_on_segment(p, b, c) || point_on_segment(p, c, a);
    return orient2d(a, b, p, u, v) * turn >= 0 && orient2d(b, c, p, u, v) * turn >= 0 &&
           orient2d(c, a, p, u, v) * turn >= 0;
}

/* Does [p, q) meet the closed segment a b? */
static bool half_open_meets_segment(const double p[3], const double q[3], const double a[3],
                                    const double b[3]) {
    if (!segments_meet(p, q, a, b))
        return false;
    if (!point_on_segment(q, a, b))
        return true;
    /* They meet in q; they meet elsewhere too only if they overlap along a line. */
    if (!collinear(p, a, b) || !collinear(p, q, a) || !collinear(p, q, b))
        return false;
    return in_box_of(p, a, b) || (in_box_of(a, p, q) && !same(a, q)) ||
           (in_box_of(b, p, q) && !same(b, q));
}

/* [p, q) against a triangle with area in the same plane, which projects injectively to (u, v) with
 * `turn`. */
static bool meets_in_plane(const double p[3], const double q[3], const double *const corner[3],
                           int u, int v, int turn) {
    int at_p[3], at_q[3];
    bool p_inside = true, q_inside = true;
    for (int k = 0; k < 3; k++) {
        at_p[k] = turn * orient2d(corner[k], corner[(k + 1) % 3], p, u, v);
        at_q[k] = turn * orient2d(corner[k], corner[(k + 1) % 3], q, u, v);
        p_inside = p_inside && at_p[k] >= 0;
        q_inside = q_inside && at_q[k] >= 0;
    }
    if (p_inside)
        return true;
    if (q_inside) {
        /* q is in the triangle: does the segment extend into it from q? */
        for (int k = 0; k < 3; k++)
            if (at_q[k] == 0 && at_p[k] < 0)
                return false;
        return true;
    }
    for (int k = 0; k < 3; k++)
        if (segments_meet(p, q, corner[k], corner[(k + 1) % 3]))
            return true;
    return false;
}

static bool meets_coplanar(const double p[3], const double q[3], const double a[3],
                           const double b[3], const double c[3]) {
    int u, v, turn = turn_in_plane(a, b, c, &u, &v);
    if (turn != 0)
        return meets_in_plane(p, q, (const double *const[]){a, b, c}, u, v, turn);
    return half_open_meets_segment(p, q, a, b) || half_open_meets_segment(p, q, b, c) ||
           half_open_meets_segment(p, q, c, a);
}

bool segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                            const double b[3], const double c[3]) {
    int at_p = orient3d(a, b, c, p);
    if (at_p == 0) {
        if (same(p, q))
            return false;
        if (orient3d(a, b, c, q) != 0)
            return point_on_triangle(p, a, b, c);
        return meets_coplanar(p, q, a, b, c);
    }
    /* p is off the plane: touching in q alone does not block [p, q) */
    if (at_p * orient3d(a, b, c, q) >= 0)
        return false;
    int s = orient3d(p, q, a, b), t = orient3d(p, q, b, c);
    if (s * t < 0)
        return false;
    int r = orient3d(p, q, c, a);
    return s * r >= 0 && t * r >= 0;
}

static bool closed_meets(const double p[3], const double q[3], const double *const t[3]) {
    return segment_meets_triangle(p, q, t[0], t[1], t[2]) || point_on_triangle(q, t[0], t[1], t[2]);
}

/* Does edge p q cross the plane of t through t? */
static bool pierces(const double p[3], const double q[3], const double *const t[3]) {
    return orient3d(t[0], t[1], t[2], p) * orient3d(t[0], t[1], t[2], q) < 0 &&
           segment_meets_triangle(p, q, t[0], t[1], t[2]);
}

/* Does some edge of s have all of t on its outer side or on its line? */
static bool separates(const double *const s[3], const double *const t[3], int u, int v, int turn) {
    for (int k = 0; k < 3; k++) {
        bool apart = true;
        for (int j = 0; j < 3 && apart; j++)
            apart = turn * orient2d(s[k], s[(k + 1) % 3], t[j], u, v) <= 0;
        if (apart)
            return true;
    }
    return false;
}

/* Are the two coplanar with an overlap of positive area? */
static bool overlap_in_plane(const double *const s[3], const double *const t[3]) {
    for (int k = 0; k < 3; k++)
        if (orient3d(t[0], t[1], t[2], s[k]) != 0)
            return false;
    int u, v, turn = turn_in_plane(s[0], s[1], s[2], &u, &v);
    int other = turn ? orient2d(t[0], t[1], t[2], u, v) : 0;
    return turn != 0 && other != 0 && !separates(s, t, u, v, turn) && !separates(t, s, u, v, other);
}

triangle_contact triangles_contact(const double *const s[3], const double *const t[3], int shared) {
    /* With one common corner only the opposite edges matter: a common segment from that corner ends
     * on one of them. With two, further contact requires coplanarity. */
    int first = shared == 1 ? 1 : 0, edges = shared == 0 ? 3 : shared == 1 ? 1 : 0;
    bool touch = false;
    if (shared == 3 || overlap_in_plane(s, t))
        return TRIANGLES_CROSS;
    for (int k = first; k < first + edges; k++) {
        const double *s0 = s[k], *s1 = s[(k + 1) % 3], *t0 = t[k], *t1 = t[(k + 1) % 3];
        if (pierces(s0, s1, t) || pierces(t0, t1, s))
            return TRIANGLES_CROSS;
        touch = touch || closed_meets(s0, s1, t) || closed_meets(t0, t1, s);
    }
    return touch ? TRIANGLES_TOUCH : shared ? TRIANGLES_SHARE : TRIANGLES_APART;
}
