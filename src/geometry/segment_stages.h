/* SPDX-License-Identifier: Apache-2.0 */
/* Does a segment meet a triangle? Written once for every kind of point; the including file says
 * what a POINT is, and gives the signs TURN3 (orient3d), TURN2 (orient2d), ORDER (of two
 * coordinates) and ALIGNED (collinear).
 *
 * Predicates only, no point is constructed: coplanar cases are decided in a coordinate plane onto
 * which the common plane projects injectively, and triangles without area are treated as their
 * edges. */

static bool same(POINT a, POINT b) {
    return ORDER(a, b, 0) == 0 && ORDER(a, b, 1) == 0 && ORDER(a, b, 2) == 0;
}

static bool in_box_of(POINT p, POINT a, POINT b) {
    bool in = true;
    for (int k = 0; k < 3 && in; k++)
        in = ORDER(a, p, k) * ORDER(p, b, k) >= 0;
    return in;
}

static bool point_on_segment(POINT p, POINT a, POINT b) {
    return in_box_of(p, a, b) && ALIGNED(a, b, p);
}

/* Finds a coordinate plane (u, v) in which a, b, c have area; returns their turn there, or 0. */
static int turn_in_plane(POINT a, POINT b, POINT c, int *u, int *v) {
    for (int k = 0; k < 3; k++) {
        *u = k;
        *v = (k + 1) % 3;
        int turn = TURN2(a, b, c, *u, *v);
        if (turn != 0)
            return turn;
    }
    return 0;
}

/* Closed segments whose four endpoints are coplanar but not all collinear. */
static bool segments_meet_in_plane(POINT a, POINT b, POINT c, POINT d, int u, int v) {
    return TURN2(a, b, c, u, v) * TURN2(a, b, d, u, v) <= 0 &&
           TURN2(c, d, a, u, v) * TURN2(c, d, b, u, v) <= 0;
}

static bool segment_meets_segment(POINT a, POINT b, POINT c, POINT d) {
    if (same(a, b))
        return point_on_segment(a, c, d);
    if (same(c, d))
        return point_on_segment(c, a, b);
    if (TURN3(a, b, c, d) != 0)
        return false;
    int u, v;
    if (turn_in_plane(a, b, c, &u, &v) != 0 || turn_in_plane(a, b, d, &u, &v) != 0)
        return segments_meet_in_plane(a, b, c, d, u, v);
    return in_box_of(c, a, b) || in_box_of(d, a, b) || in_box_of(a, c, d);
}

static bool triangle_holds(POINT p, POINT a, POINT b, POINT c) {
    if (TURN3(a, b, c, p) != 0)
        return false;
    int u, v, turn = turn_in_plane(a, b, c, &u, &v);
    if (turn == 0)
        return point_on_segment(p, a, b) || point_on_segment(p, b, c) || point_on_segment(p, c, a);
    return TURN2(a, b, p, u, v) * turn >= 0 && TURN2(b, c, p, u, v) * turn >= 0 &&
           TURN2(c, a, p, u, v) * turn >= 0;
}

/* Does [p, q) meet the closed segment a b? */
static bool half_open_meets_segment(POINT p, POINT q, POINT a, POINT b) {
    if (!segment_meets_segment(p, q, a, b))
        return false;
    if (!point_on_segment(q, a, b))
        return true;
    /* They meet in q; they meet elsewhere too only if they overlap along a line. */
    if (!ALIGNED(p, a, b) || !ALIGNED(p, q, a) || !ALIGNED(p, q, b))
        return false;
    return in_box_of(p, a, b) || (in_box_of(a, p, q) && !same(a, q)) ||
           (in_box_of(b, p, q) && !same(b, q));
}

/* [p, q) against a triangle with area in the same plane, which projects injectively to (u, v) with
 * `turn`. */
static bool meets_in_plane(POINT p, POINT q, POINT const corner[3], int u, int v, int turn) {
    int at_p[3], at_q[3];
    bool p_inside = true, q_inside = true;
    for (int k = 0; k < 3; k++) {
        at_p[k] = turn * TURN2(corner[k], corner[(k + 1) % 3], p, u, v);
        at_q[k] = turn * TURN2(corner[k], corner[(k + 1) % 3], q, u, v);
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
        if (segment_meets_segment(p, q, corner[k], corner[(k + 1) % 3]))
            return true;
    return false;
}

static bool meets_coplanar(POINT p, POINT q, POINT a, POINT b, POINT c) {
    int u, v, turn = turn_in_plane(a, b, c, &u, &v);
    if (turn != 0)
        return meets_in_plane(p, q, (POINT const[]){a, b, c}, u, v, turn);
    return half_open_meets_segment(p, q, a, b) || half_open_meets_segment(p, q, b, c) ||
           half_open_meets_segment(p, q, c, a);
}

static bool half_open_meets_triangle(POINT p, POINT q, POINT a, POINT b, POINT c) {
    int at_p = TURN3(a, b, c, p);
    if (at_p == 0) {
        if (same(p, q))
            return false;
        if (TURN3(a, b, c, q) != 0)
            return triangle_holds(p, a, b, c);
        return meets_coplanar(p, q, a, b, c);
    }
    /* p is off the plane: touching in q alone does not block [p, q) */
    if (at_p * TURN3(a, b, c, q) >= 0)
        return false;
    int s = TURN3(p, q, a, b), t = TURN3(p, q, b, c);
    if (s * t < 0)
        return false;
    int r = TURN3(p, q, c, a);
    return s * r >= 0 && t * r >= 0;
}
