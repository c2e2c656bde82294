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

enum { MOST_PARTS = 6 }; /* of a weighted sum of three doubles */

/* x is added to a sum of doubles that do not overlap, the smallest first (Shewchuk's
 * GROW-EXPANSION); returns how many there are then. */
static int grow(double *part, int count, double x) {
    int kept = 0;
    for (int i = 0; i < count; i++) {
        double sum = x + part[i], of_part = sum - x;
        double lost = (x - (sum - of_part)) + (part[i] - of_part);
        x = sum;
        if (lost != 0)
            part[kept++] = lost;
    }
    if (x != 0)
        part[kept++] = x;
    return kept;
}

/* VERIFY_UNIT times coordinate k of a spot, as a sum without rounding. */
static int spread_coordinate(const verify_spot *spot, int k, double part[MOST_PARTS]) {
    int count = 0;
    if (spot->blur == 0)
        return grow(part, 0, VERIFY_UNIT * spot->at[k]);
    for (int i = 0; i < 3; i++) {
        double product = spot->weight[i] * spot->corner[i][k];
        count = grow(part, count, fma(spot->weight[i], spot->corner[i][k], -product));
        count = grow(part, count, product);
    }
    return count;
}

/* VERIFY_UNIT times a spot: the sum of some vectors. */
typedef struct vectors {
    int count;
    double x[MOST_PARTS][3];
} vectors;

static vectors spread(const verify_spot *spot) {
    vectors v = {0, {{0}}};
    for (int k = 0; k < 3; k++) {
        double part[MOST_PARTS];
        int count = spread_coordinate(spot, k, part);
        for (int i = 0; i < count; i++)
            v.x[i][k] = part[i];
        v.count = count > v.count ? count : v.count;
    }
    return v;
}

static void add_determinant(exact_sum *sum, const vectors *a, const vectors *b, const vectors *c) {
    for (int i = 0; i < a->count; i++)
        for (int j = 0; j < b->count; j++)
            for (int k = 0; k < c->count; k++)
                exact_sum_add_determinant(sum, a->x[i], b->x[j], c->x[k]);
}

static int exact_side(const verify_spot *a, const verify_spot *b, const verify_spot *c,
                      const verify_spot *p) {
    const vectors u = spread(a), v = spread(b), w = spread(c), x = spread(p);
    exact_sum sum;
    exact_sum_clear(&sum);
    add_determinant(&sum, &u, &v, &w);
    add_determinant(&sum, &v, &u, &x);
    add_determinant(&sum, &u, &w, &x);
    add_determinant(&sum, &w, &v, &x);
    return exact_sum_sign(&sum);
}

/* Is coordinate k of the spot x, and those of the vertices that it is between? */
static bool lies_at(const verify_spot *spot, int k, double x) {
    if (spot->blur == 0)
        return spot->at[k] == x;
    return spot->corner[0][k] == x && spot->corner[1][k] == x && spot->corner[2][k] == x;
}

/* The common cause of a zero: all four are in an axis-aligned plane. */
static bool plainly_flat(const verify_spot *a, const verify_spot *b, const verify_spot *c,
                         const verify_spot *p) {
    for (int k = 0; k < 3; k++) {
        double x = a->blur == 0 ? a->at[k] : a->corner[0][k];
        if (lies_at(a, k, x) && lies_at(b, k, x) && lies_at(c, k, x) && lies_at(p, k, x))
            return true;
    }
    return false;
}

/* 0 if it is not certain. Coordinates are off by no more than `blur`: 2 blur for differences, and
 * no product of three differences, of which the largest is `widest`, changes by more than three
 * times that and the square of the largest. */
static int rounded_side(const double a[3], const double b[3], const double c[3], const double p[3],
                        double blur) {
    double u[3], v[3], w[3], widest = 2 * blur;
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
    if (blur > 0) {
        for (int k = 0; k < 3; k++)
            widest = fmax(widest, fmax(fabs(u[k]), fmax(fabs(v[k]), fabs(w[k]))) + 2 * blur);
        bound += 40 * blur * (widest * widest);
    }
    return (sum > bound) - (sum < -bound);
}

int verify_side(const double a[3], const double b[3], const double c[3], const double p[3]) {
    int side = rounded_side(a, b, c, p, 0);
    if (side != 0 || same(p, a) || same(p, b) || same(p, c))
        return side;
    const verify_spot s[4] = {verify_plain(a), verify_plain(b), verify_plain(c), verify_plain(p)};
    return plainly_flat(&s[0], &s[1], &s[2], &s[3]) ? 0 : exact_side(&s[0], &s[1], &s[2], &s[3]);
}

/* verify_side of spots */
static int side_of(const verify_spot *a, const verify_spot *b, const verify_spot *c,
                   const verify_spot *p) {
    double blur = fmax(fmax(a->blur, b->blur), fmax(c->blur, p->blur));
    if (blur == 0)
        return verify_side(a->at, b->at, c->at, p->at);
    int side = rounded_side(a->at, b->at, c->at, p->at, blur);
    return side != 0 || plainly_flat(a, b, c, p) ? side : exact_side(a, b, c, p);
}

int verify_spot_side(const double a[3], const double b[3], const double c[3],
                     const verify_spot *q) {
    if (q->blur == 0)
        return verify_side(a, b, c, q->at);
    const verify_spot s[3] = {verify_plain(a), verify_plain(b), verify_plain(c)};
    return side_of(&s[0], &s[1], &s[2], q);
}

static void add_turn(exact_sum *sum, const vectors *a, const vectors *b, int u, int v) {
    for (int i = 0; i < a->count; i++)
        for (int j = 0; j < b->count; j++) {
            exact_sum_add(sum, a->x[i][u], b->x[j][v], 1);
            exact_sum_add(sum, -a->x[i][v], b->x[j][u], 1);
        }
}

/* a x b + b x c + c x a in the plane of u and v */
static int exact_turn(const double a[3], const double b[3], const verify_spot *c, int u, int v) {
    const verify_spot s[2] = {verify_plain(a), verify_plain(b)};
    const vectors corner[3] = {spread(&s[0]), spread(&s[1]), spread(c)};
    exact_sum sum;
    exact_sum_clear(&sum);
    for (int i = 0; i < 3; i++)
        add_turn(&sum, &corner[i], &corner[(i + 1) % 3], u, v);
    return exact_sum_sign(&sum);
}

int verify_spot_turn(const double a[3], const double b[3], const verify_spot *c, int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double from[2] = {b[u] - a[u], b[v] - a[v]}, to[2] = {c->at[u] - a[u], c->at[v] - a[v]};
    double plus = from[0] * to[1], minus = from[1] * to[0];
    double bound = ROUNDING * (fabs(plus) + fabs(minus)) + UNDERFLOW +
                   2 * c->blur * (fabs(from[0]) + fabs(from[1]));
    if (plus - minus > bound)
        return 1;
    return plus - minus < -bound ? -1 : exact_turn(a, b, c, u, v);
}

int verify_turn(const double a[3], const double b[3], const double c[3], int axis) {
    const verify_spot spot = verify_plain(c);
    return verify_spot_turn(a, b, &spot, axis);
}

int verify_spot_compare(const verify_spot *q, int k, double x) {
    double apart = q->at[k] - x, part[MOST_PARTS + 1];
    if (q->blur == 0 || fabs(apart) > 2 * q->blur)
        return (apart > 0) - (apart < 0);
    int count = grow(part, spread_coordinate(q, k, part), -VERIFY_UNIT * x);
    return count == 0 ? 0 : part[count - 1] > 0 ? 1 : -1;
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
static bool meet_on_line(const double p[3], const verify_spot *q, const double a[3],
                         const double b[3]) {
    for (int k = 0; k < 3; k++) {
        int ahead = verify_spot_compare(q, k, p[k]);
        if (ahead == 0)
            continue;
        double low = fmin(a[k], b[k]),
               high = fmax(a[k], b[k]); /* the order along k is that on the line */
        return ahead > 0 ? verify_spot_compare(q, k, low) > 0 && high >= p[k]
                         : verify_spot_compare(q, k, high) < 0 && low <= p[k];
    }
    return false; /* p is q */
}

/* Does [p, q) meet [a, b], on which p does not lie? */
static bool blocked_by_segment(const double p[3], const verify_spot *q, const double a[3],
                               const double b[3]) {
    if (verify_spot_side(p, a, b, q) != 0)
        return false;
    for (int axis = 0; axis < 3; axis++) {
        int a_side = verify_spot_turn(a, p, q, axis), b_side = verify_spot_turn(b, p, q, axis);
        int p_side = verify_turn(a, b, p, axis), q_side = verify_spot_turn(a, b, q, axis);
        if (a_side == 0 && b_side == 0 && p_side == 0 && q_side == 0)
            continue; /* their plane is seen edge-on */
        /* On different lines that meet in one point, which is q if q is on the other line. */
        return a_side * b_side <= 0 && p_side * q_side < 0;
    }
    return meet_on_line(p, q, a, b);
}

/* Does the line p q, which is not in the plane of t, pass through t or its boundary? */
static bool line_meets(const double p[3], const verify_spot *q, const double *const t[3]) {
    int plus = 0, minus = 0;
    for (int i = 0; i < 3; i++) {
        int side = verify_spot_side(p, t[i], t[(i + 1) % 3], q);
        plus += side > 0;
        minus += side < 0;
    }
    return plus == 0 || minus == 0;
}

/* Are the bounds of p and of some spots certainly apart from those of t? */
static bool bounds_apart(const double p[3], const verify_spot *spots, int count,
                         const double *const t[3]) {
    for (int k = 0; k < 3; k++) {
        double low = p[k], high = p[k];
        for (int i = 0; i < count; i++) {
            double least = spots[i].at[k] - spots[i].blur, most = spots[i].at[k] + spots[i].blur;
            low = least < low ? least : low;
            high = most > high ? most : high;
        }
        if ((t[0][k] < low && t[1][k] < low && t[2][k] < low) ||
            (t[0][k] > high && t[1][k] > high && t[2][k] > high))
            return true;
    }
    return false;
}

/* Are the vertices that a spot is between all corners of t? */
static bool holds(const double *const t[3], const verify_spot *q) {
    bool all = q->blur > 0;
    for (int i = 0; i < 3 && all; i++)
        all = q->weight[i] == 0 || same(q->corner[i], t[0]) || same(q->corner[i], t[1]) ||
              same(q->corner[i], t[2]);
    return all;
}

bool verify_blocks_from(int p_side, const double p[3], const verify_spot *q,
                        const double *const t[3]) {
    if (bounds_apart(p, q, 1, t))
        return false;
    int q_side = holds(t, q) ? 0 : verify_spot_side(t[0], t[1], t[2], q);
    if (p_side != 0) /* then t has area; ending in its plane at q is no contact */
        return p_side * q_side < 0 && line_meets(p, q, t);
    if (q_side != 0)
        return false; /* the segment meets the plane only at p, which is not on t */
    /* All coplanar, or t without area: from p, off t, a segment reaches t only through an edge. */
    return blocked_by_segment(p, q, t[0], t[1]) || blocked_by_segment(p, q, t[1], t[2]) ||
           blocked_by_segment(p, q, t[2], t[0]);
}

bool verify_blocks(const double p[3], const double q[3], const double *const t[3]) {
    const verify_spot spot = verify_plain(q);
    return !bounds_apart(p, &spot, 1, t) &&
           verify_blocks_from(verify_side(t[0], t[1], t[2], p), p, &spot, t);
}

/* ---- triangles ----
 *
 * The intersection of t and the tetrahedron is the hull of points each of which is a corner of t in
 * the tetrahedron, or where an edge of t meets a side of it, or where an edge of it meets t. Off
 * the part, edges of the tetrahedron are the segments from p to its corners, which t does not
 * block; so there remains a corner of t in the tetrahedron off the face, or an edge of t that
 * passes through the interior of one of the three sides at p. */

bool verify_enters(const double p[3], const double *const face[3], const verify_spot part[3],
                   const double *const t[3]) {
    const verify_spot from = verify_plain(p);
    int side[3][3], height[3];
    if (bounds_apart(p, part, 3, t))
        return false;
    for (int j = 0; j < 3; j++)
        height[j] = verify_side(face[0], face[1], face[2], t[j]);
    if (height[0] <= 0 && height[1] <= 0 && height[2] <= 0)
        return false;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const verify_spot corner = verify_plain(t[j]);
            side[i][j] = side_of(&part[(i + 1) % 3], &part[i], &from, &corner);
        }
        if (side[i][0] < 0 && side[i][1] < 0 && side[i][2] < 0)
            return false;
    }
    for (int j = 0; j < 3; j++)
        if (height[j] > 0 && side[0][j] >= 0 && side[1][j] >= 0 && side[2][j] >= 0)
            return true;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const verify_spot u = verify_plain(t[j]), v = verify_plain(t[(j + 1) % 3]);
            const verify_spot *next = &part[(i + 1) % 3];
            if (side[i][j] * side[i][(j + 1) % 3] >= 0)
                continue;
            int turn = verify_spot_side(u.at, v.at, p, &part[i]);
            if (turn != 0 && side_of(&u, &v, &part[i], next) == turn &&
                verify_spot_side(u.at, v.at, p, next) == -turn)
                return true;
        }
    return false;
}

static bool edge_passes(const double *const s[3], const double *const t[3]) {
    int side[3];
    for (int i = 0; i < 3; i++)
        side[i] = verify_side(t[0], t[1], t[2], s[i]);
    for (int i = 0; i < 3; i++) {
        const verify_spot end = verify_plain(s[(i + 1) % 3]);
        if (side[i] * side[(i + 1) % 3] < 0 && line_meets(s[i], &end, t))
            return true;
    }
    return false;
}

static bool edge_pierces(const double *const s[3], const double *const t[3]) {
    for (int i = 0; i < 3; i++) {
        const double *p = s[i], *q = s[(i + 1) % 3];
        int turn = verify_side(p, q, t[0], t[1]);
        if (verify_side(t[0], t[1], t[2], p) * verify_side(t[0], t[1], t[2], q) < 0 && turn != 0 &&
            verify_side(p, q, t[1], t[2]) == turn && verify_side(p, q, t[2], t[0]) == turn)
            return true;
    }
    return false;
}

bool verify_pierce(const double *const s[3], const double *const t[3]) {
    return edge_pierces(s, t) || edge_pierces(t, s);
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
