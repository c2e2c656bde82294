/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of a plane by insertion [Lawson 1977, Sloan 1993].
 *
 * - A point is found by a walk and splits the triangle or the edge on which it lies.
 * - A segment goes from vertex to vertex: along an edge where one leads its way, otherwise up to
 *   the first vertex or the first earlier segment that it meets. The latter is split where the two
 *   lines cross; edges between are flipped away (geometry/constrained.c).
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

#include "geometry/vec3.h"

static const uint32_t NONE = PLANAR_NONE;

enum { FLIPS_PER_TRIANGLE = 32 };

/* ---- structure ---- */

void triangulation_free(triangulation *t) {
    planar_free(&t->mesh);
    RELEASE(t->carriers.data, t->used.data);
}

static int turn(const void *self, uint32_t a, uint32_t b, uint32_t c) {
    const triangulation *t = self;
    return exact_points_turn(t->points, a, b, c, t->u, t->v);
}

/* Room for a point's place in `at`. */
static starg_status make_known(triangulation *t, uint32_t point) {
    while (t->mesh.at.count <= point)
        PUSH(t->mesh.context, UNION_STAGE, &t->mesh.at, NONE);
    if (t->mesh.at.data[point] == NONE)
        PUSH(t->mesh.context, UNION_STAGE, &t->used, point);
    return STARG_OK;
}

static void link_rim(triangulation *t, uint32_t h, planar_rim beyond) {
    planar_link(&t->mesh, h, beyond.twin, beyond.mark);
}

starg_status triangulation_begin(triangulation *t, const double *const plane[3], int u, int v,
                                 const uint32_t enclosing[3]) {
    uint32_t first;
    for (size_t i = 0; i < t->used.count; i++)
        t->mesh.at.data[t->used.data[i]] = NONE;
    planar_clear(&t->mesh);
    t->mesh.turn = turn;
    t->mesh.points = t;
    t->used.count = t->carriers.count = 0;
    memcpy(t->plane, plane, sizeof t->plane);
    t->u = u;
    t->v = v;
    for (int k = 0; k < 3; k++)
        TRY(make_known(t, enclosing[k]));
    TRY(planar_add(&t->mesh, &first));
    planar_set(&t->mesh, first, enclosing[0], enclosing[1], enclosing[2]);
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
        out->side[k] = turn(t, planar_start(&t->mesh, h), planar_end(&t->mesh, h), point);
        if (out->side[k] < 0)
            return false;
    }
    return true;
}

/* Walks towards the point. Such a walk may go round in circles; then all triangles are tried. */
static place locate(const triangulation *t, uint32_t point) {
    place found;
    uint32_t triangle = t->mesh.last, count = (uint32_t)(t->mesh.corner.count / 3);
    for (uint32_t step = 0; step < count + 4; step++) {
        if (holds(t, triangle, point, &found))
            return found;
        uint32_t h = 3 * triangle;
        while (found.side[h - 3 * triangle] >= 0)
            h++;
        triangle = t->mesh.twin.data[h] / 3;
    }
    for (triangle = 0; triangle < count && !holds(t, triangle, point, &found); triangle++)
        ;
    return found;
}

static starg_status split_triangle(triangulation *t, uint32_t triangle, uint32_t point) {
    uint32_t piece[3] = {triangle}, corner[3];
    planar_rim beyond[3];
    for (uint32_t k = 0; k < 3; k++) {
        corner[k] = t->mesh.corner.data[3 * triangle + k];
        beyond[k] = planar_rim_of(&t->mesh, 3 * triangle + k);
    }
    TRY(planar_add(&t->mesh, &piece[1]));
    TRY(planar_add(&t->mesh, &piece[2]));
    for (uint32_t k = 0; k < 3; k++) {
        planar_set(&t->mesh, piece[k], corner[k], corner[(k + 1) % 3], point);
        link_rim(t, 3 * piece[k], beyond[k]);
    }
    for (uint32_t k = 0; k < 3; k++)
        planar_link(&t->mesh, 3 * piece[k] + 1, 3 * piece[(k + 1) % 3] + 2, NONE);
    return STARG_OK;
}

/* The triangles (a, b, c) and (b, a, d) at an inner edge become four. */
static starg_status split_edge(triangulation *t, uint32_t h, uint32_t point) {
    uint32_t g = t->mesh.twin.data[h], carrier = t->mesh.mark.data[h], left = h / 3, right = g / 3;
    uint32_t a = planar_start(&t->mesh, h), b = planar_end(&t->mesh, h),
             c = planar_tip(&t->mesh, h), d = planar_tip(&t->mesh, g);
    planar_rim bc = planar_rim_of(&t->mesh, planar_next(h)),
               ca = planar_rim_of(&t->mesh, planar_previous(h));
    planar_rim ad = planar_rim_of(&t->mesh, planar_next(g)),
               db = planar_rim_of(&t->mesh, planar_previous(g));
    uint32_t more_left, more_right;
    TRY(planar_add(&t->mesh, &more_left));
    TRY(planar_add(&t->mesh, &more_right));
    planar_set(&t->mesh, left, a, point, c);
    planar_set(&t->mesh, more_left, point, b, c);
    planar_set(&t->mesh, right, b, point, d);
    planar_set(&t->mesh, more_right, point, a, d);
    link_rim(t, 3 * more_left + 1, bc);
    link_rim(t, 3 * left + 2, ca);
    link_rim(t, 3 * more_right + 1, ad);
    link_rim(t, 3 * right + 2, db);
    planar_link(&t->mesh, 3 * left, 3 * more_right, carrier);
    planar_link(&t->mesh, 3 * more_left, 3 * right, carrier);
    planar_link(&t->mesh, 3 * left + 1, 3 * more_left + 2, NONE);
    planar_link(&t->mesh, 3 * right + 1, 3 * more_right + 2, NONE);
    return STARG_OK;
}

starg_status triangulation_insert(triangulation *t, uint32_t point) {
    TRY(make_known(t, point));
    if (t->mesh.at.data[point] != NONE)
        return STARG_OK;
    place found = locate(t, point);
    for (uint32_t k = 0; k < 3; k++)
        if (found.side[k] == 0)
            return split_edge(t, 3 * found.triangle + k, point);
    return split_triangle(t, found.triangle, point);
}

/* ---- segments ---- */

/* Does c, on the line of a and b, lie on the same side of a as b? */
static bool lies_ahead(const triangulation *t, uint32_t a, uint32_t b, uint32_t c) {
    int axis = exact_points_compare(t->points, a, b, t->u) != 0 ? t->u : t->v;
    return exact_points_compare(t->points, a, b, axis) ==
           exact_points_compare(t->points, a, c, axis);
}

/* How the way from a to b begins: a halfedge from a that it follows, or (*along false) the one
 * that it crosses. */
static uint32_t first_step(const triangulation *t, uint32_t a, uint32_t b, bool *along) {
    for (uint32_t h = t->mesh.at.data[a];; h = planar_around(&t->mesh, h)) {
        int right = turn(t, a, b, planar_end(&t->mesh, h));
        *along = planar_end(&t->mesh, h) == b ||
                 (right == 0 && lies_ahead(t, a, b, planar_end(&t->mesh, h)));
        if (*along)
            return h;
        if (right < 0 && planar_tip(&t->mesh, h) != b && turn(t, a, b, planar_tip(&t->mesh, h)) > 0)
            return planar_next(h);
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
    cross(t, other, &t->carriers.data[t->mesh.mark.data[h]], &meeting);
    TRY(exact_points_add(t->points, &meeting, point));
    TRY(make_known(t, *point));
    return split_edge(t, h, *point);
}

static void mark(triangulation *t, uint32_t h, uint32_t carrier) {
    if (t->mesh.mark.data[h] == NONE)
        planar_link(&t->mesh, h, t->mesh.twin.data[h], carrier);
}

starg_status triangulation_constrain(triangulation *t, uint32_t a, uint32_t b,
                                     triangulation_carrier carrier) {
    uint32_t own = (uint32_t)t->carriers.count;
    PUSH(t->mesh.context, UNION_STAGE, &t->carriers, carrier);
    while (a != b) {
        bool along;
        uint32_t h = first_step(t, a, b, &along), next = planar_end(&t->mesh, h);
        if (!along) {
            uint32_t met;
            bool done;
            TRY(planar_march(&t->mesh, h, a, b, &next, &met));
            if (met != NONE)
                TRY(split_crossing(t, met, &carrier, &next));
            TRY(planar_flip_away(&t->mesh, a, next, true, &done));
            h = planar_find(&t->mesh, a, next);
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
    uint32_t g = t->mesh.twin.data[h];
    double c[2], s[2];
    angle_at(t, planar_tip(&t->mesh, h), planar_start(&t->mesh, h), planar_end(&t->mesh, h), &c[0],
             &s[0]);
    angle_at(t, planar_tip(&t->mesh, g), planar_start(&t->mesh, g), planar_end(&t->mesh, g), &c[1],
             &s[1]);
    double left = s[0] * c[1], right = c[0] * s[1];
    return left + right < -1e-6 * (fabs(left) + fabs(right));
}

starg_status triangulation_improve(triangulation *t) {
    size_t flips = 0, most = FLIPS_PER_TRIANGLE * t->mesh.corner.count / 3;
    bool changed = true;
    while (changed && flips < most) {
        changed = false;
        for (uint32_t h = 0; h < t->mesh.corner.count && flips < most; h++) {
            uint32_t g = t->mesh.twin.data[h];
            if (g < h || g == NONE || t->mesh.mark.data[h] != NONE)
                continue;
            if (!wants_flip(t, h) || !planar_can_flip(&t->mesh, h))
                continue;
            planar_flip(&t->mesh, h);
            changed = true;
            flips++;
        }
        TRY(starg_check_cancel(t->mesh.context, UNION_STAGE));
    }
    return STARG_OK;
}
