/* SPDX-License-Identifier: Apache-2.0 */
/* Intersection tests by predicates only, without constructing points. */
#include "geometry/intersect.h"

#include "geometry/predicates.h"

/* x lies between a and b exactly if the signs of a - x and x - b do not differ. */
static int order(double x, double y) {
    return (x > y) - (x < y);
}

#define POINT                const double *
#define TURN3(a, b, c, d)    orient3d(a, b, c, d)
#define TURN2(a, b, c, u, v) orient2d(a, b, c, u, v)
#define ORDER(a, b, k)       order((a)[k], (b)[k])
#define ALIGNED(a, b, c)     collinear(a, b, c)
#include "geometry/segment_stages.h"

bool segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                            const double b[3], const double c[3]) {
    return half_open_meets_triangle(p, q, a, b, c);
}

bool segments_meet(const double a[3], const double b[3], const double c[3], const double d[3]) {
    return segment_meets_segment(a, b, c, d);
}

bool point_on_triangle(const double p[3], const double a[3], const double b[3], const double c[3]) {
    return triangle_holds(p, a, b, c);
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
