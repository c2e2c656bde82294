/* SPDX-License-Identifier: Apache-2.0 */
/* The shaft of a point v and a box c: the union of the segments from v to the points of c, which is
 * conv(v, c), and what surely misses it.
 *
 * Faces of the shaft that hold v pass through an edge of the box; such an edge is parallel to an
 * axis, and so the plane is that of a line in the projection along this axis: there the shaft is
 * the hull of a point and a rectangle, with at most two lines through the point. The other faces
 * are faces of the hull's bounding box. So the shaft is the intersection of that box and at most
 * six half-spaces, each given by two numbers.
 *
 * A segment misses the shaft if both ends lie strictly outside of one of these twelve planes, or if
 * the box lies strictly on one side of the plane of the segment and v: then the shaft without v
 * does, and the segment, which does not hold v, lies in the plane. "Strictly" means by more than
 * the rounding error; what is not certain counts as meeting the shaft.
 *
 * Error bounds. All differences carry one rounding. A product of two carries three, a sum of two
 * such products four: below 8 x 2^-53 of the sum of the absolute products. A component of a cross
 * product has four, times a difference six, a sum of three such eight: below 16 x 2^-53 of the sum
 * of absolute products. Underflows lose less than TINY of each. */
#ifndef STARG_VISIBILITY_BOX_SHAFT_H
#define STARG_VISIBILITY_BOX_SHAFT_H

#include <math.h>
#include <stdbool.h>

#include "geometry/bvh.h"

#define SHAFT_TINY_2 1e-290 /* for products of two differences below 2e100   */
#define SHAFT_TINY_3 1e-200 /* for products of three                         */

typedef struct box_shaft {
    double v[3];
    bvh_box box, hull;      /* c; the bounding box of v and c                               */
    double low[3], high[3]; /* corners of c, relative to v                                  */
    double side[6][2];      /* planes 2k and 2k + 1 look along axis k: with d = p - v, p is
                               outside if side[0] d[k + 1] + side[1] d[k + 2] > 0           */
} box_shaft;

/* Bits of a code: p is strictly outside of these planes of the shaft. */
#define SHAFT_HULL  0x3fu  /* those of the bounding box */
#define SHAFT_SIDES 0xfc0u /* those that hold v         */

/* The two lines through v about the rectangle in the projection along axis k. Where the point lies
 * beside the rectangle says which of its corners they pass: counter-clockwise and clockwise. */
static inline void shaft_make_sides(box_shaft *s, int k) {
    /* by zone of (u, w): below, within, above; 0 the low corner, 1 the high one */
    static const signed char corners[3][3][4] = {{{0, 1, 1, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}},
                                                 {{0, 0, 1, 0}, {-1, 0, 0, 0}, {1, 1, 0, 1}},
                                                 {{0, 0, 1, 1}, {1, 0, 1, 1}, {1, 0, 0, 1}}};
    int u = (k + 1) % 3, w = (k + 2) % 3;
    int zone_u = s->v[u] < s->box.lower[u] ? 0 : s->v[u] > s->box.upper[u] ? 2 : 1;
    int zone_w = s->v[w] < s->box.lower[w] ? 0 : s->v[w] > s->box.upper[w] ? 2 : 1;
    const signed char *c = corners[zone_u][zone_w];
    double *left = s->side[2 * k], *right = s->side[2 * k + 1];
    left[0] = left[1] = right[0] = right[1] = 0;
    if (c[0] < 0)
        return; /* v is seen through the rectangle: no lines */
    left[0] = -(c[1] ? s->high[w] : s->low[w]);
    left[1] = c[0] ? s->high[u] : s->low[u];
    right[0] = c[3] ? s->high[w] : s->low[w];
    right[1] = -(c[2] ? s->high[u] : s->low[u]);
}

static inline void shaft_make(box_shaft *s, const double v[3], const bvh_box *box) {
    s->box = *box;
    for (int k = 0; k < 3; k++) {
        s->v[k] = v[k];
        s->hull.lower[k] = v[k] < box->lower[k] ? v[k] : box->lower[k];
        s->hull.upper[k] = v[k] > box->upper[k] ? v[k] : box->upper[k];
        s->low[k] = box->lower[k] - v[k];
        s->high[k] = box->upper[k] - v[k];
    }
    for (int k = 0; k < 3; k++)
        shaft_make_sides(s, k);
}

static inline unsigned shaft_code(const box_shaft *s, const double p[3]) {
    const double d[5] = {p[0] - s->v[0], p[1] - s->v[1], p[2] - s->v[2], p[0] - s->v[0],
                         p[1] - s->v[1]};
    unsigned code = 0;
    for (int k = 0; k < 3; k++)
        code |= (unsigned)(p[k] < s->hull.lower[k]) << k | (unsigned)(p[k] > s->hull.upper[k])
                                                               << (3 + k);
    for (int i = 0; i < 6; i++) {
        double x = s->side[i][0] * d[i / 2 + 1], y = s->side[i][1] * d[i / 2 + 2];
        code |= (unsigned)(x + y > 8 * 0x1p-53 * (fabs(x) + fabs(y)) + SHAFT_TINY_2) << (6 + i);
    }
    return code;
}

/* Does c lie strictly on one side of the plane of v, p and q? */
static inline bool shaft_is_beside(const box_shaft *s, const double p[3], const double q[3]) {
    double a[3], b[3], least = 0, most = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = p[k] - s->v[k];
        b[k] = q[k] - s->v[k];
    }
    for (int k = 0; k < 3; k++) {
        int u = k == 2 ? 0 : k + 1, w = k == 0 ? 2 : k - 1;
        double x = a[u] * b[w], y = a[w] * b[u];
        double low = (x - y) * s->low[k], high = (x - y) * s->high[k];
        least += low < high ? low : high;
        most += low < high ? high : low;
        size += (fabs(x) + fabs(y)) * fmax(fabs(s->low[k]), fabs(s->high[k]));
    }
    double bound = 16 * 0x1p-53 * size + SHAFT_TINY_3;
    return least > bound || most < -bound;
}

/* May the edge meet the shaft? False only if it surely does not. */
static inline bool shaft_may_meet(const box_shaft *s, const double p[3], unsigned code_p,
                                  const double q[3], unsigned code_q) {
    if (code_p & code_q)
        return false;
    return code_p == 0 || code_q == 0 || !shaft_is_beside(s, p, q);
}

#endif
