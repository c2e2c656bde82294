/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of a plane by insertion [Lawson 1977, Sloan 1993].
 *
 * - A point is found by a walk and splits the triangle or the edge on which it lies.
 * - A segment goes from vertex to vertex: along an edge where one leads its way, otherwise up to
 *   the first vertex or the first earlier segment that it meets. The latter is split where the two
 *   lines cross; edges between are flipped away.
 * - At the end edges are flipped towards the Delaunay triangulation of the plane, so that rounding
 *   of the points turns over as few triangles as may be. Floating point chooses these flips; that
 *   one is possible is decided exactly.
 *
 * Crossings are computed from the carriers of the segments (lines of vertices, planes of faces),
 * never from earlier crossings: numbers do not grow.
 *
 * Invariants: triangles turn left in the projection and fill the enclosing one; twins are mutual.
 * Cost: O(n sqrt n) for the walks as a rule; a segment costs the square of the edges it crosses at
 * worst. */
#include "mesh/union/arrangement.h"

#include "core/rng.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

static const char STAGE[] = "union";

enum { FLIPS_PER_TRIANGLE = 32 };

/* ---- structure ---- */

void triangulation_free(triangulation *t) {
    RELEASE(t->corner.data, t->twin.data, t->carrier.data, t->carriers.data, t->at.data,
            t->used.data, t->crossed.data);
}

static int turn(const triangulation *t, uint32_t a, uint32_t b, uint32_t c) {
    return exact_points_turn(t->points, a, b, c, t->u, t->v);
}

static uint32_t start_of(const triangulation *t, uint32_t h) {
    return t->corner.data[h];
}

static uint32_t end_of(const triangulation *t, uint32_t h) {
    return t->corner.data[corner_next(h)];
}

static uint32_t tip_of(const triangulation *t, uint32_t h) {
    return t->corner.data[corner_previous(h)];
}

/* Room for a point's place in `at`. */
static starg_status make_known(triangulation *t, uint32_t point) {
    while (t->at.count <= point)
        PUSH(t->context, STAGE, &t->at, TRIANGULATION_NONE);
    if (t->at.data[point] == TRIANGULATION_NONE)
        PUSH(t->context, STAGE, &t->used, point);
    return STARG_OK;
}

static starg_status add_triangle(triangulation *t, uint32_t *triangle) {
    *triangle = (uint32_t)(t->corner.count / 3);
    for (int k = 0; k < 3; k++) {
        PUSH(t->context, STAGE, &t->corner, TRIANGULATION_NONE);
        PUSH(t->context, STAGE, &t->twin, TRIANGULATION_NONE);
        PUSH(t->context, STAGE, &t->carrier, TRIANGULATION_NONE);
    }
    return STARG_OK;
}

static void set_triangle(triangulation *t, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t corner[3] = {a, b, c};
    for (uint32_t k = 0; k < 3; k++) {
        t->corner.data[3 * triangle + k] = corner[k];
        t->at.data[corner[k]] = 3 * triangle + k;
    }
    t->last = triangle;
}

/* Halfedge h lies against `twin` (or on the border), on that carrier. */
static void link(triangulation *t, uint32_t h, uint32_t twin, uint32_t carrier) {
    t->twin.data[h] = twin;
    t->carrier.data[h] = carrier;
    if (twin == TRIANGULATION_NONE)
        return;
    t->twin.data[twin] = h;
    t->carrier.data[twin] = carrier;
}

/* What lies beyond a halfedge, while triangles are rearranged. */
typedef struct rim {
    uint32_t twin, carrier;
} rim;

static rim rim_of(const triangulation *t, uint32_t h) {
    return (rim){t->twin.data[h], t->carrier.data[h]};
}

static void link_rim(triangulation *t, uint32_t h, rim beyond) {
    link(t, h, beyond.twin, beyond.carrier);
}

starg_status triangulation_begin(triangulation *t, const double *const plane[3], int u, int v,
                                 const uint32_t enclosing[3]) {
    uint32_t first;
    for (size_t i = 0; i < t->used.count; i++)
        t->at.data[t->used.data[i]] = TRIANGULATION_NONE;
    t->used.count = t->corner.count = t->twin.count = t->carrier.count = t->carriers.count = 0;
    memcpy(t->plane, plane, sizeof t->plane);
    t->u = u;
    t->v = v;
    for (int k = 0; k < 3; k++)
        TRY(make_known(t, enclosing[k]));
    TRY(add_triangle(t, &first));
    set_triangle(t, first, enclosing[0], enclosing[1], enclosing[2]);
    return STARG_OK;
}

/* ---- points ---- */

/* The triangle that holds a point, and where the point lies in it. */
typedef struct place {
    uint32_t triangle;
    int side[3]; /* of the point against each halfedge; 0: on it */
} place;

static bool holds(const triangulation *t, uint32_t triangle, uint32_t point, place *out) {
    out->triangle = triangle;
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t h = 3 * triangle + k;
        out->side[k] = turn(t, start_of(t, h), end_of(t, h), point);
        if (out->side[k] < 0)
            return false;
    }
    return true;
}

/* Walks towards the point. Such a walk may go round in circles; then all triangles are tried. */
static place locate(const triangulation *t, uint32_t point) {
    place found;
    uint32_t triangle = t->last, count = (uint32_t)(t->corner.count / 3);
    for (uint32_t step = 0; step < count + 4; step++) {
        if (holds(t, triangle, point, &found))
            return found;
        uint32_t h = 3 * triangle;
        while (found.side[h - 3 * triangle] >= 0)
            h++;
        triangle = t->twin.data[h] / 3;
    }
    for (triangle = 0; triangle < count && !holds(t, triangle, point, &found); triangle++)
        ;
    return found;
}

static starg_status split_triangle(triangulation *t, uint32_t triangle, uint32_t point) {
    uint32_t piece[3] = {triangle}, corner[3];
    rim beyond[3];
    for (uint32_t k = 0; k < 3; k++) {
        corner[k] = t->corner.data[3 * triangle + k];
        beyond[k] = rim_of(t, 3 * triangle + k);
    }
    TRY(add_triangle(t, &piece[1]));
    TRY(add_triangle(t, &piece[2]));
    for (uint32_t k = 0; k < 3; k++) {
        set_triangle(t, piece[k], corner[k], corner[(k + 1) % 3], point);
        link_rim(t, 3 * piece[k], beyond[k]);
    }
    for (uint32_t k = 0; k < 3; k++)
        link(t, 3 * piece[k] + 1, 3 * piece[(k + 1) % 3] + 2, TRIANGULATION_NONE);
    return STARG_OK;
}

/* The triangles (a, b, c) and (b, a, d) at an inner edge become four. */
static starg_status split_edge(triangulation *t, uint32_t h, uint32_t point) {
    uint32_t g = t->twin.data[h], carrier = t->carrier.data[h], left = h / 3, right = g / 3;
    uint32_t a = start_of(t, h), b = end_of(t, h), c = tip_of(t, h), d = tip_of(t, g);
    rim bc = rim_of(t, corner_next(h)), ca = rim_of(t, corner_previous(h));
    rim ad = rim_of(t, corner_next(g)), db = rim_of(t, corner_previous(g));
    uint32_t more_left, more_right;
    TRY(add_triangle(t, &more_left));
    TRY(add_triangle(t, &more_right));
    set_triangle(t, left, a, point, c);
    set_triangle(t, more_left, point, b, c);
    set_triangle(t, right, b, point, d);
    set_triangle(t, more_right, point, a, d);
    link_rim(t, 3 * more_left + 1, bc);
    link_rim(t, 3 * left + 2, ca);
    link_rim(t, 3 * more_right + 1, ad);
    link_rim(t, 3 * right + 2, db);
    link(t, 3 * left, 3 * more_right, carrier);
    link(t, 3 * more_left, 3 * right, carrier);
    link(t, 3 * left + 1, 3 * more_left + 2, TRIANGULATION_NONE);
    link(t, 3 * right + 1, 3 * more_right + 2, TRIANGULATION_NONE);
    return STARG_OK;
}

starg_status triangulation_insert(triangulation *t, uint32_t point) {
    TRY(make_known(t, point));
    if (t->at.data[point] != TRIANGULATION_NONE)
        return STARG_OK;
    place found = locate(t, point);
    for (uint32_t k = 0; k < 3; k++)
        if (found.side[k] == 0)
            return split_edge(t, 3 * found.triangle + k, point);
    return split_triangle(t, found.triangle, point);
}

/* ---- flips ---- */

/* Do the two triangles at a halfedge form a strictly convex quadrangle? */
static bool can_flip(const triangulation *t, uint32_t h) {
    uint32_t g = t->twin.data[h];
    if (g == TRIANGULATION_NONE || t->carrier.data[h] != TRIANGULATION_NONE)
        return false;
    uint32_t a = start_of(t, h), b = end_of(t, h), c = tip_of(t, h), d = tip_of(t, g);
    return turn(t, a, d, c) > 0 && turn(t, d, b, c) > 0;
}

/* (a, b, c) and (b, a, d) become (a, d, c) and (d, b, c). */
static void flip(triangulation *t, uint32_t h) {
    uint32_t g = t->twin.data[h], one = h / 3, two = g / 3;
    uint32_t a = start_of(t, h), b = end_of(t, h), c = tip_of(t, h), d = tip_of(t, g);
    rim bc = rim_of(t, corner_next(h)), ca = rim_of(t, corner_previous(h));
    rim ad = rim_of(t, corner_next(g)), db = rim_of(t, corner_previous(g));
    set_triangle(t, one, a, d, c);
    set_triangle(t, two, d, b, c);
    link_rim(t, 3 * one, ad);
    link_rim(t, 3 * one + 2, ca);
    link_rim(t, 3 * two, db);
    link_rim(t, 3 * two + 1, bc);
    link(t, 3 * one + 1, 3 * two + 2, TRIANGULATION_NONE);
}

/* ---- segments ---- */

/* The next halfedge from the same vertex, counter-clockwise. */
static uint32_t around(const triangulation *t, uint32_t h) {
    return t->twin.data[corner_previous(h)];
}

/* The halfedge from a to b, which is there. One of them is no enclosing point, about which one does
 * not get all around. */
static uint32_t find_edge(const triangulation *t, uint32_t a, uint32_t b) {
    uint32_t h = t->at.data[a];
    while (h != TRIANGULATION_NONE && end_of(t, h) != b)
        h = around(t, h);
    return h != TRIANGULATION_NONE ? h : t->twin.data[find_edge(t, b, a)];
}

/* Does c, on the line of a and b, lie on the same side of a as b? */
static bool lies_ahead(const triangulation *t, uint32_t a, uint32_t b, uint32_t c) {
    int axis = exact_points_compare(t->points, a, b, t->u) != 0 ? t->u : t->v;
    return exact_points_compare(t->points, a, b, axis) ==
           exact_points_compare(t->points, a, c, axis);
}

/* How the way from a to b begins: a halfedge from a that it follows, or (*along false) the one
 * that it crosses. */
static uint32_t first_step(const triangulation *t, uint32_t a, uint32_t b, bool *along) {
    for (uint32_t h = t->at.data[a];; h = around(t, h)) {
        int right = turn(t, a, b, end_of(t, h));
        *along = end_of(t, h) == b || (right == 0 && lies_ahead(t, a, b, end_of(t, h)));
        if (*along)
            return h;
        if (right < 0 && tip_of(t, h) != b && turn(t, a, b, tip_of(t, h)) > 0)
            return corner_next(h);
    }
}

static void cross(const triangulation *t, const triangulation_carrier *a,
                  const triangulation_carrier *b, exact_point *out) {
    int scale = t->points->scale;
    if (a->corner[2] == NULL && b->corner[2] == NULL) {
        exact_point_on_line(out, a->corner[0], a->corner[1], b->corner[0], b->corner[1], t->u, t->v,
                            scale);
        return;
    }
    const triangulation_carrier *line = a->corner[2] == NULL ? a : b, *face = line == a ? b : a;
    exact_plane plane[3];
    exact_plane_set(&plane[0], face->corner, scale);
    if (line->corner[2] == NULL) {
        exact_point_on_plane(out, line->corner[0], line->corner[1], &plane[0], scale);
        return;
    }
    exact_plane_set(&plane[1], line->corner, scale);
    exact_plane_set(&plane[2], t->plane, scale);
    exact_point_of_planes(out, (const exact_plane *const[]){&plane[0], &plane[1], &plane[2]},
                          scale);
}

/* Splits the segment on a halfedge where another carrier crosses it. */
static starg_status split_crossing(triangulation *t, uint32_t h, const triangulation_carrier *other,
                                   uint32_t *point) {
    exact_point meeting;
    cross(t, other, &t->carriers.data[t->carrier.data[h]], &meeting);
    TRY(exact_points_add(t->points, &meeting, point));
    TRY(make_known(t, *point));
    return split_edge(t, h, *point);
}

/* Lists the free edges that the way from a towards b crosses, the first of them `h`, up to a
 * vertex on it: *target, made where it crosses a segment. */
static starg_status march(triangulation *t, uint32_t h, uint32_t a, uint32_t b,
                          const triangulation_carrier *carrier, uint32_t *target) {
    t->crossed.count = 0;
    for (;;) {
        if (t->carrier.data[h] != TRIANGULATION_NONE) {
            TRY(split_crossing(t, h, carrier, target));
            return STARG_OK;
        }
        uint64_t edge = (uint64_t)start_of(t, h) << 32 | end_of(t, h);
        PUSH(t->context, STAGE, &t->crossed, edge);
        h = t->twin.data[h];
        *target = tip_of(t, h);
        int side = *target == b ? 0 : turn(t, a, b, *target);
        if (side == 0)
            return STARG_OK;
        h = side > 0 ? corner_next(h) : corner_previous(h);
    }
    return STARG_OK;
}

/* Does the segment between a and b cross the edge c d? They have no vertex on each other. */
static bool crosses(const triangulation *t, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    bool apart = c != a && c != b && d != a && d != b;
    return apart && turn(t, a, b, c) * turn(t, a, b, d) < 0;
}

/* Flips the listed edges until a b is one. Those whose quadrangle is not convex wait for others. A
 * flip to an edge that is crossed too only happens every other time, at random: some sequence of
 * flips always leads to the end, and no circle lasts. */
static starg_status flip_away(triangulation *t, uint32_t a, uint32_t b) {
    for (size_t i = 0; i < t->crossed.count; i++) {
        uint64_t edge = t->crossed.data[i];
        uint32_t h = find_edge(t, (uint32_t)(edge >> 32), (uint32_t)edge);
        if (can_flip(t, h)) {
            uint32_t c = tip_of(t, h), d = tip_of(t, t->twin.data[h]);
            bool again = crosses(t, a, b, c, d);
            if (!again || starg_hash64(i) % 2 == 0) {
                flip(t, h);
                edge = (uint64_t)c << 32 | d;
            }
            if (!again)
                continue;
        }
        PUSH(t->context, STAGE, &t->crossed, edge);
        if (i % 1024 == 1023)
            TRY(starg_check_cancel(t->context, STAGE));
    }
    return STARG_OK;
}

static void mark(triangulation *t, uint32_t h, uint32_t carrier) {
    if (t->carrier.data[h] == TRIANGULATION_NONE)
        link(t, h, t->twin.data[h], carrier);
}

starg_status triangulation_constrain(triangulation *t, uint32_t a, uint32_t b,
                                     triangulation_carrier carrier) {
    uint32_t own = (uint32_t)t->carriers.count;
    PUSH(t->context, STAGE, &t->carriers, carrier);
    while (a != b) {
        bool along;
        uint32_t h = first_step(t, a, b, &along), next = end_of(t, h);
        if (!along) {
            TRY(march(t, h, a, b, &carrier, &next));
            TRY(flip_away(t, a, next));
            h = find_edge(t, a, next);
        }
        mark(t, h, own);
        a = next;
    }
    return STARG_OK;
}

/* ---- shape ---- */

/* Cosine (times lengths) and sine (times lengths) of the angle at `tip`. */
static void angle_at(const triangulation *t, uint32_t tip, uint32_t a, uint32_t b, double *cosine,
                     double *sine) {
    const double *p = exact_points_rounded(t->points, tip);
    double x[3], y[3], normal[3];
    vec3_subtract(exact_points_rounded(t->points, a), p, x);
    vec3_subtract(exact_points_rounded(t->points, b), p, y);
    vec3_cross(x, y, normal);
    *cosine = vec3_dot(x, y);
    *sine = vec3_length(normal);
}

/* Do the angles opposite to the edge have a sum well above 180 degrees? */
static bool wants_flip(const triangulation *t, uint32_t h) {
    uint32_t g = t->twin.data[h];
    double c[2], s[2];
    angle_at(t, tip_of(t, h), start_of(t, h), end_of(t, h), &c[0], &s[0]);
    angle_at(t, tip_of(t, g), start_of(t, g), end_of(t, g), &c[1], &s[1]);
    double left = s[0] * c[1], right = c[0] * s[1];
    return left + right < -1e-6 * (fabs(left) + fabs(right));
}

starg_status triangulation_improve(triangulation *t) {
    size_t flips = 0, most = FLIPS_PER_TRIANGLE * t->corner.count / 3;
    bool changed = true;
    while (changed && flips < most) {
        changed = false;
        for (uint32_t h = 0; h < t->corner.count && flips < most; h++) {
            uint32_t g = t->twin.data[h];
            if (g < h || g == TRIANGULATION_NONE || t->carrier.data[h] != TRIANGULATION_NONE)
                continue;
            if (!wants_flip(t, h) || !can_flip(t, h))
                continue;
            flip(t, h);
            changed = true;
            flips++;
        }
        TRY(starg_check_cancel(t->context, STAGE));
    }
    return STARG_OK;
}
