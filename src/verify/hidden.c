/* SPDX-License-Identifier: Apache-2.0 */
/* Checks stated reasons why something is hidden from a box; docs/formats.md lists them.
 * Independent of the engine that finds reasons (visibility/box.h): only one box is rounded, the
 * part of a box behind the plane of a face, and exact signs then show that it contains all of that
 * part. Whatever the engine decides with certainty is decided the same way here, so its reasons
 * pass.
 *
 * The shaft of a vertex v and a box is the union of the segments between them. An edge misses it if
 * a plane separates them: across an axis; through v and parallel to an axis, along the silhouette
 * of the box as seen from v in that projection; or through v and the edge, with all of the box
 * strictly on one side. All of these signs are exact also where v is a point between the vertices
 * of a face (verify/signs.h), so that the proofs hold for it as they stand: they use of v only that
 * it is strictly beside the faces of a patch. But s and f, which look at the faces around v, are of
 * vertices alone. The range is that to the doubles next to v, as docs/visibility.md defines it.
 *
 * Why the reasons suffice. Let c be the box, cut to the bounding box of the model (with a capital
 * letter: a box that exact signs show to hold all of c on the inner side of the face, from where
 * alone the face is seen). A patch grows from a face over every edge that is not certain to miss
 * the shaft. It closes if v is strictly on the same side of all its faces.
 *
 * 1. A patch that closes hides open parts. Let a segment from v to a point p of c meet the patch in
 *    x, not in p. The faces at x cover all directions near that of x: a face around its inside; two
 *    faces at an edge, which lie on different sides of it as seen from v because both turn the same
 *    side to v; the whole fan at a corner, all of whose edges meet the shaft in x. So points of c
 *    near p are hidden as well. And the set of hidden points is closed, as the patch is.
 * 2. p. No face of the patch meets c, so by 1 the hidden points of c are an open and closed part of
 *    c. The centre is one of them, and c is connected: all are.
 * 3. s. Around v the faces cut the sphere of directions along a simple closed curve. Planes keep
 *    the directions to c off it, so either all lead into the model or none. That to the centre does
 *    not: no face around v has the centre on its inner side, or an arc from it crosses first a face
 *    that has it on the outer side. So every segment from c inside the model leaves it before v.
 * 4. e. Let G be a connected part of c inside the model. If the surface did not touch its closure,
 *    G would be all of c, and no face would meet c. So the closure has a point y on a face that
 *    meets c, and this face is in a patch that closes with v on the outer side. Seen from v, the
 *    faces at y cover all directions about y once, with the inside of the model behind them: points
 *    of G near y are hidden, and with 1 all of G is, as no point inside lies on a patch.
 * 5. f. Patches grow over faces that do not hold v, as far as those that do. Only points of c
 *    matter whose directions from v lead into the model; by 1 the hidden ones are an open and
 *    closed part of these. Let H be a connected part of them. Unless H is all of c, its closure
 *    has a direction along a face t around v; beyond the far edge of t the neighbour, strictly on
 *    the inner side of t, begins a patch that closes, and t does not meet c. So points of H next
 *    to it are hidden, and all of H is. If H is all of c, the centre is hidden, whose segment
 *    begins outside the model or meets a patch.
 * 6. o. No face meets the box, so it is inside or outside as a whole; its centre has no winding
 *    number above 0.
 * 7. c. The distance of the middle from the surface and half of the diagonal are less than the
 *    clearance. Both are rounded; a two-thousandth of the clearance is left for that.
 *
 * Cost of a reason: the faces of a patch within the shaft, some 100 ns each. */
#include "verify/everywhere.h"

#include <math.h>

#include "core/memory.h"
#include "verify/signs.h"

/* At most two lines through v per projection. */
enum { LINES = 6 };

typedef struct outline {
    int axis;
    const double *through; /* with v: the line */
    int outer;             /* the turn of points beyond it */
} outline;

typedef struct shaft {
    uint32_t vertex; /* UINT32_MAX: v is between vertices */
    verify_spot v;
    const verify_box *box;
    double corner[24]; /* of the box */
    outline lines[LINES];
    int line_count;
} shaft;

struct verify_watch {
    const verify_scene *scene;
    verify_box box; /* the current box; contains every point of the solid in the original one */
    bool empty;     /* none of it is within the bounds of the surface */
    STARG_ARRAY(uint32_t) met; /* faces that meet the box; valid if `met_known` */
    bool met_known, failed;    /* out of memory: nothing is proven then */
    uint32_t *visit;           /* by face: number of the last flood that visited it */
    uint32_t flood;
    uint32_t *stack; /* faces */
};

/* ---- faces and boxes ---- */

static void box_corner(const verify_box *box, int i, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = i >> k & 1 ? box->upper[k] : box->lower[k];
}

/* Of coordinate k, is the spot within the box? */
static bool holds_along(const verify_box *box, const verify_spot *p, int k) {
    return verify_spot_compare(p, k, box->lower[k]) >= 0 &&
           verify_spot_compare(p, k, box->upper[k]) <= 0;
}

static bool holds(const verify_box *box, const verify_spot *p) {
    return holds_along(box, p, 0) && holds_along(box, p, 1) && holds_along(box, p, 2);
}

static bool bounds_apart(const double *const t[3], const verify_box *box) {
    for (int k = 0; k < 3; k++)
        if ((t[0][k] < box->lower[k] && t[1][k] < box->lower[k] && t[2][k] < box->lower[k]) ||
            (t[0][k] > box->upper[k] && t[1][k] > box->upper[k] && t[2][k] > box->upper[k]))
            return true;
    return false;
}

/* Are all corners strictly on one side of a b c? Exchanging two points turns the side of the other
 * two: the spot may stand in the last place. */
static bool box_is_beside(const double a[3], const double b[3], const verify_spot *c,
                          const double corner[24]) {
    int side = verify_spot_side(a, b, corner, c);
    for (int i = 1; i < 8 && side != 0; i++)
        if (verify_spot_side(a, b, corner + 3 * i, c) != side)
            return false;
    return side != 0;
}

/* Corners of a box that form its outline along an axis. */
static const int RECTANGLE[3][4] = {{0, 2, 4, 6}, {0, 1, 4, 5}, {0, 1, 2, 3}};

/* Along an axis, is the box strictly beyond the line of an edge of the triangle? */
static bool edge_keeps_apart(const double *const t[3], const double corner[24], int axis) {
    for (int i = 0; i < 3; i++) {
        const double *a = t[i], *b = t[(i + 1) % 3];
        int side = verify_turn(a, b, corner, axis);
        for (int j = 1; j < 4 && side != 0; j++)
            if (verify_turn(a, b, corner + 3 * RECTANGLE[axis][j], axis) != side)
                side = 0;
        if (side != 0 && verify_turn(a, b, t[(i + 2) % 3], axis) != side)
            return true;
    }
    return false;
}

/* Separating axis test: two convex bodies are disjoint exactly if an axis normal to a face of one
 * or to two edges separates them; the latter are the sides of the triangle projected along the
 * edges of the box. */
static bool face_meets_box(const double *const t[3], const verify_box *box) {
    double corner[24];
    if (bounds_apart(t, box))
        return false;
    for (int i = 0; i < 8; i++)
        box_corner(box, i, corner + 3 * i);
    const verify_spot last = verify_plain(t[2]);
    if (box_is_beside(t[0], t[1], &last, corner))
        return false;
    for (int axis = 0; axis < 3; axis++)
        if (edge_keeps_apart(t, corner, axis))
            return false;
    return true;
}

static bool add_met(void *data, uint32_t face) {
    verify_watch *w = data;
    const double *t[3];
    verify_corners(w->scene->surface, face, t);
    if (!face_meets_box(t, &w->box))
        return true;
    if (w->met.count == w->met.capacity) {
        size_t capacity = 2 * w->met.capacity + 64;
        uint32_t *grown = starg_reallocate(w->scene->surface->context, w->met.data, w->met.count,
                                           capacity, sizeof *grown);
        if (grown == NULL) {
            w->failed = true;
            return false;
        }
        w->met.data = grown;
        w->met.capacity = capacity;
    }
    w->met.data[w->met.count++] = face;
    return true;
}

/* Lists the faces that meet the box; false when out of memory. */
static bool list_met(verify_watch *w) {
    if (!w->met_known) {
        w->met.count = 0;
        verify_tree_visit(w->scene->tree, w->box.lower, w->box.upper, add_met, w);
        w->met_known = true;
    }
    return !w->failed;
}

static void centre_of(const verify_box *box, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = fmin(fmax(0.5 * box->lower[k] + 0.5 * box->upper[k], box->lower[k]), box->upper[k]);
}

/* ---- the part of a box on the inner side of a face ---- */

static bool no_corner_is_inner(const double *const t[3], const verify_box *box) {
    double p[3];
    for (int i = 0; i < 8; i++) {
        box_corner(box, i, p);
        if (verify_side(t[0], t[1], t[2], p) > 0)
            return false;
    }
    return true;
}

/* Cuts away what is beyond `at` on one side of axis k, if none of it is on the inner side. */
static void cut(const double *const t[3], const verify_box *whole, int k, bool upper, double at,
                verify_box *out) {
    verify_box away = *whole;
    if (!(at >= whole->lower[k] && at <= whole->upper[k]))
        return;
    *(upper ? &away.lower[k] : &away.upper[k]) = at;
    if (no_corner_is_inner(t, &away))
        *(upper ? &out->upper[k] : &out->lower[k]) = at;
}

/* *out contains all of the box that is on the inner side. With the outward normal n the function n
 * . (x - a) is negative there; along an axis the inner side extends to the zero of its minimum over
 * the other axes. Margins keep the exact signs from failing. */
static void clip(const double *const t[3], const verify_box *box, verify_box *out) {
    double normal[3], least[3], u[3], v[3], sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
    }
    for (int k = 0; k < 3; k++) {
        double x = u[(k + 1) % 3] * v[(k + 2) % 3], y = u[(k + 2) % 3] * v[(k + 1) % 3];
        double low = box->lower[k] - t[0][k], high = box->upper[k] - t[0][k];
        normal[k] = x - y;
        least[k] = fmin(normal[k] * low, normal[k] * high);
        sum += least[k];
        size += (fabs(x) + fabs(y)) * fmax(fabs(low), fabs(high));
    }
    *out = *box;
    double bound = 16 * 0x1p-53 * size + 1e-200;
    for (int k = 0; k < 3; k++) {
        double a = t[0][k], reach = (least[k] - sum) / normal[k];
        double margin = 4 * bound / fabs(normal[k]) + 8 * 0x1p-53 * (fabs(reach) + fabs(a));
        if (normal[k] > 0 && a + reach + margin < box->upper[k])
            cut(t, box, k, true, fmax(a + reach + margin, box->lower[k]), out);
        if (normal[k] < 0 && a + reach - margin > box->lower[k])
            cut(t, box, k, false, fmin(a + reach - margin, box->upper[k]), out);
    }
}

/* ---- the shaft ---- */

/* The lines through v along the silhouette of the box, as seen along an axis; none if v is inside
 * it. */
static void add_lines(shaft *s, int axis) {
    int u = (axis + 1) % 3, w = (axis + 2) % 3;
    if (holds_along(s->box, &s->v, u) && holds_along(s->box, &s->v, w))
        return;
    bool done[2] = {false, false};
    for (int i = 0; i < 4; i++) {
        int plus = 0, minus = 0;
        const double *through = s->corner + 3 * RECTANGLE[axis][i];
        for (int j = 0; j < 4; j++) {
            const double *other = s->corner + 3 * RECTANGLE[axis][j];
            int turn = i == j ? 0 : verify_spot_turn(through, other, &s->v, axis);
            plus += turn > 0;
            minus += turn < 0;
        }
        for (int outer = -1; outer <= 1; outer += 2)
            if (!done[outer > 0] && (outer > 0 ? plus : minus) == 0) {
                s->lines[s->line_count++] = (outline){axis, through, outer};
                done[outer > 0] = true;
            }
    }
}

static void make_shaft(const verify_spot *v, uint32_t vertex, const verify_box *box, shaft *s) {
    s->vertex = vertex;
    s->v = *v;
    s->box = box;
    s->line_count = 0;
    for (int i = 0; i < 8; i++)
        box_corner(box, i, s->corner + 3 * i);
    for (int axis = 0; axis < 3; axis++)
        add_lines(s, axis);
}

static bool line_keeps_apart(const shaft *s, const double a[3], const double b[3]) {
    for (int i = 0; i < s->line_count; i++) {
        const outline *line = &s->lines[i];
        if (verify_spot_turn(line->through, a, &s->v, line->axis) == line->outer &&
            verify_spot_turn(line->through, b, &s->v, line->axis) == line->outer)
            return true;
    }
    return false;
}

/* Does the segment from a to b, which does not contain v, miss the shaft? */
static bool misses(const shaft *s, const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++) {
        double least = fmin(a[k], b[k]), most = fmax(a[k], b[k]);
        if ((most < s->box->lower[k] && verify_spot_compare(&s->v, k, most) > 0) ||
            (least > s->box->upper[k] && verify_spot_compare(&s->v, k, least) < 0))
            return true;
    }
    return line_keeps_apart(s, a, b) || box_is_beside(a, b, &s->v, s->corner);
}

/* Do the directions from v, a vertex, to the points of segment a b miss those to the box? */
static bool directions_miss(const shaft *s, const double a[3], const double b[3]) {
    const double *v = s->v.at;
    for (int k = 0; k < 3; k++)
        if ((s->box->lower[k] > v[k] && a[k] <= v[k] && b[k] <= v[k]) ||
            (s->box->upper[k] < v[k] && a[k] >= v[k] && b[k] >= v[k]))
            return true;
    return line_keeps_apart(s, a, b) || box_is_beside(a, b, &s->v, s->corner);
}

/* ---- patches ---- */

/* How a flood fails, or stops: see the head of this file. */
typedef enum flood_kind { PATCH, FOLD, ENTRY } flood_kind;

static bool has_corner(const verify_surface *surface, uint32_t face, uint32_t vertex) {
    const uint32_t *c = surface->faces + 3 * (size_t)face;
    return c[0] == vertex || c[1] == vertex || c[2] == vertex;
}

static bool admits(const verify_watch *w, const shaft *s, uint32_t face, int side,
                   flood_kind kind) {
    const verify_surface *surface = w->scene->surface;
    const double *t[3];
    verify_corners(surface, face, t);
    return !has_corner(surface, face, s->vertex) &&
           verify_spot_side(t[0], t[1], t[2], &s->v) == side &&
           (kind == ENTRY || !face_meets_box(t, s->box));
}

static void begin_flood(verify_watch *w) {
    if (w->flood == UINT32_MAX) {
        memset(w->visit, 0, w->scene->surface->face_count * sizeof *w->visit);
        w->flood = 0;
    }
    w->flood++;
}

/* Floods from the seed across edges that meet the shaft. True: v is strictly on `side` of all faces
 * of the patch, and none of them meets the box (except for entries). */
static bool closes(verify_watch *w, const shaft *s, uint32_t seed, int side, flood_kind kind) {
    const verify_scene *scene = w->scene;
    size_t depth = 0;
    begin_flood(w);
    w->stack[depth++] = seed;
    w->visit[seed] = w->flood;
    while (depth > 0) {
        uint32_t face = w->stack[--depth];
        const double *t[3];
        if (!admits(w, s, face, side, kind))
            return false;
        verify_corners(scene->surface, face, t);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t next = scene->twin[3 * (size_t)face + k] / 3;
            if (w->visit[next] == w->flood || misses(s, t[k], t[(k + 1) % 3]) ||
                (kind == FOLD && has_corner(scene->surface, next, s->vertex)))
                continue;
            w->visit[next] = w->flood;
            w->stack[depth++] = next;
        }
    }
    return true;
}

/* A patch with a face that meets the segment from v to the centre of the box. */
static bool patch_hides(verify_watch *w, const shaft *s, uint32_t seed, flood_kind kind) {
    const double *t[3];
    double centre[3];
    if (seed >= w->scene->surface->face_count)
        return false;
    verify_corners(w->scene->surface, seed, t);
    centre_of(s->box, centre);
    int side = verify_spot_side(t[0], t[1], t[2], &s->v);
    return side != 0 && !verify_on_triangle(centre, t) &&
           verify_blocks_from(verify_side(t[0], t[1], t[2], centre), centre, &s->v, t) &&
           closes(w, s, seed, side, kind);
}

/* All faces that meet the box face away from v, in closed patches. */
static bool entry_hides(verify_watch *w, const shaft *s) {
    bool any = false;
    if (!list_met(w))
        return false;
    for (size_t i = 0; i < w->met.count; i++) {
        const double *t[3];
        verify_corners(w->scene->surface, w->met.data[i], t);
        if (s->box != &w->box && !face_meets_box(t, s->box))
            continue;
        if (!w->scene->sound[w->met.data[i]] || !closes(w, s, w->met.data[i], -1, ENTRY))
            return false;
        any = true;
    }
    return any;
}

/* ---- where segments begin ---- */

/* The other corners of the face of directed edge e, which starts at v, in order. */
static void beyond_vertex(const verify_scene *scene, uint32_t e, const double *ends[2]) {
    const double *t[3];
    verify_corners(scene->surface, e / 3, t);
    ends[0] = t[(e + 1) % 3];
    ends[1] = t[(e + 2) % 3];
}

static uint32_t turn_about(const verify_scene *scene, uint32_t e) {
    return scene->twin[e % 3 == 0 ? e + 2 : e - 1];
}

/* Does the arc of directions from d to e cross only arcs of faces at v that have d on their outer
 * side, at least one, and each of them properly? */
static bool leads_in(const verify_scene *scene, const shaft *s, const double d[3],
                     const double e[3]) {
    uint32_t first = scene->outgoing[s->vertex], edge = first;
    bool any = false;
    do {
        const double *end[2];
        beyond_vertex(scene, edge, end);
        int a = verify_side(d, e, end[0], s->v.at), b = verify_side(d, e, end[1], s->v.at);
        int at_d = verify_side(end[0], end[1], d, s->v.at),
            at_e = verify_side(end[0], end[1], e, s->v.at);
        if (a == 0 || b == 0 || at_e == 0)
            return false;
        if (a != b && at_d == -at_e && a == at_e) {
            if (verify_side(s->v.at, end[0], end[1], d) >= 0)
                return false;
            any = true;
        }
        edge = turn_about(scene, edge);
    } while (edge != first);
    return any;
}

/* A point a little beyond the middle of a b, as seen from v along the arc from d. */
static void overshoot(const double v[3], const double d[3], const double *const end[2],
                      double e[3]) {
    double to_d[3], to_middle[3], long_d = 0, long_middle = 0;
    for (int k = 0; k < 3; k++) {
        to_d[k] = d[k] - v[k];
        to_middle[k] = (0.5 * end[0][k] - 0.5 * v[k]) + (0.5 * end[1][k] - 0.5 * v[k]);
        long_d += to_d[k] * to_d[k];
        long_middle += to_middle[k] * to_middle[k];
    }
    double ratio = 0.03125 * sqrt(long_middle) / sqrt(long_d);
    for (int k = 0; k < 3; k++)
        e[k] = v[k] + 0.5 * (to_middle[k] - ratio * to_d[k]);
}

static bool is_near(const double p[3]) {
    return fabs(p[0]) < 1e100 && fabs(p[1]) < 1e100 && fabs(p[2]) < 1e100;
}

/* Does the direction from v to the centre of the box lead out of the solid, or along a face? */
static bool starts_outside(const verify_scene *scene, const shaft *s) {
    uint32_t first = scene->outgoing[s->vertex], edge = first;
    double d[3], e[3];
    bool inner = false;
    centre_of(s->box, d);
    do {
        const double *end[2];
        beyond_vertex(scene, edge, end);
        inner = inner || verify_side(s->v.at, end[0], end[1], d) > 0;
        edge = turn_about(scene, edge);
    } while (edge != first);
    if (!inner)
        return true;
    do {
        const double *end[2];
        beyond_vertex(scene, edge, end);
        if (verify_side(s->v.at, end[0], end[1], d) < 0) {
            overshoot(s->v.at, d, end, e);
            if (is_near(e) && leads_in(scene, s, d, e))
                return true;
        }
        edge = turn_about(scene, edge);
    } while (edge != first);
    return false;
}

static bool start_hides(const verify_scene *scene, const shaft *s) {
    uint32_t first = scene->outgoing[s->vertex], edge = first;
    do {
        const double *end[2];
        beyond_vertex(scene, edge, end);
        if (!directions_miss(s, end[0], end[1]))
            return false;
        edge = turn_about(scene, edge);
    } while (edge != first);
    return starts_outside(scene, s);
}

/* ---- folds ---- */

/* Does a closed patch continue on the inner side, beyond the face of this edge, whose directions
 * may meet those to the box? */
static bool goes_on(verify_watch *w, const shaft *s, uint32_t edge) {
    const verify_scene *scene = w->scene;
    const double *t[3], *n[3];
    uint32_t across = scene->twin[edge % 3 == 2 ? edge - 2 : edge + 1];
    verify_corners(scene->surface, edge / 3, t);
    verify_corners(scene->surface, across / 3, n);
    if (face_meets_box(t, s->box) || verify_side(t[0], t[1], t[2], n[(across + 2) % 3]) <= 0)
        return false;
    int side = verify_side(n[0], n[1], n[2], s->v.at);
    return side != 0 && closes(w, s, across / 3, side, FOLD);
}

static bool fold_hides(verify_watch *w, const shaft *s, uint32_t seed) {
    const verify_scene *scene = w->scene;
    uint32_t first = scene->outgoing[s->vertex], edge = first;
    do {
        const double *end[2];
        beyond_vertex(scene, edge, end);
        if (!directions_miss(s, end[0], end[1]) && !goes_on(w, s, edge))
            return false;
        edge = turn_about(scene, edge);
    } while (edge != first);
    return starts_outside(scene, s) || patch_hides(w, s, seed, FOLD);
}

/* ---- reasons ---- */

static bool is_far(const verify_box *box, const double v[3], double range) {
    double nearest[3];
    for (int k = 0; k < 3; k++)
        nearest[k] = fmin(fmax(v[k], box->lower[k]), box->upper[k]);
    return !verify_within(nearest, v, range);
}

/* From a box, by the point itself: a vertex, or one between vertices. */
static bool hides_spot(verify_watch *w, const verify_spot *v, uint32_t vertex,
                       const verify_box *box, double range, const verify_reason *reason) {
    const verify_scene *scene = w->scene;
    shaft s;
    if (reason->kind == 'r')
        return is_far(box, v->at, range);
    if (holds(box, v) || (strchr("sf", reason->kind) != NULL &&
                          (vertex == UINT32_MAX || !scene->sound_about[vertex])))
        return false;
    make_shaft(v, vertex, box, &s);
    switch (reason->kind) {
    case 's':
        return start_hides(scene, &s);
    case 'p':
        return patch_hides(w, &s, reason->seed, PATCH);
    case 'f':
        return fold_hides(w, &s, reason->seed);
    case 'e':
        return entry_hides(w, &s);
    default:
        return false;
    }
}

/* From where a point of a face is seen at all: from the inner side of that. */
static bool hides_of_face(verify_watch *w, uint32_t face, const verify_spot *v, uint32_t vertex,
                          double range, const verify_reason *reason) {
    const double *t[3];
    verify_box left = w->box;
    verify_corners(w->scene->surface, face, t);
    if (reason->kind == 'n')
        return no_corner_is_inner(t, &w->box);
    if (reason->clipped)
        clip(t, &w->box, &left);
    return hides_spot(w, v, vertex, &left, range, reason);
}

bool verify_box_hides(verify_watch *w, starg_target kind, uint32_t target, double range,
                      const verify_reason *reason) {
    const verify_surface *surface = w->scene->surface;
    verify_spot v = {0};
    if (w->empty)
        return true;
    if (reason->kind != 'n') {
        if (reason->vertex >= surface->vertex_count ||
            w->scene->outgoing[reason->vertex] == UINT32_MAX)
            return false;
        v = verify_plain(surface->vertices + 3 * (size_t)reason->vertex);
    }
    if (kind == STARG_TARGET_VERTICES)
        return reason->kind != 'n' && !reason->clipped && reason->vertex == target &&
               hides_spot(w, &v, target, &w->box, range, reason);
    return (reason->kind == 'n' || has_corner(surface, target, reason->vertex)) &&
           hides_of_face(w, target, &v, reason->vertex, range, reason);
}

bool verify_box_hides_point(verify_watch *w, uint32_t face, const verify_spot *point, double range,
                            const verify_reason *reason) {
    return w->empty || (reason->vertex == UINT32_MAX &&
                        hides_of_face(w, face, point, UINT32_MAX, range, reason));
}

bool verify_box_outside(verify_watch *w) {
    double centre[3];
    bool on_surface;
    if (w->empty)
        return true;
    if (!list_met(w) || w->met.count > 0)
        return false;
    centre_of(&w->box, centre);
    int winding = verify_tree_winding(w->scene->tree, centre, &on_surface);
    return !on_surface && winding < 1;
}

/* ---- memory ---- */

bool verify_watch_failed(const verify_watch *w) {
    return w->failed;
}

/* Nothing outside the bounds of the surface is in the solid. */
void verify_watch_box(verify_watch *w, const verify_box *box) {
    const verify_surface *surface = w->scene->surface;
    w->met_known = w->empty = false;
    for (int k = 0; k < 3; k++) {
        w->box.lower[k] = fmax(box->lower[k], surface->lower[k]);
        w->box.upper[k] = fmin(box->upper[k], surface->upper[k]);
        w->empty = w->empty || !(w->box.lower[k] <= w->box.upper[k]);
    }
}

starg_status verify_watch_create(const verify_scene *scene, verify_watch **out) {
    starg_context *context = scene->surface->context;
    size_t faces = scene->surface->face_count;
    verify_watch *w = starg_allocate_zero(context, 1, sizeof *w);
    *out = NULL;
    if (w == NULL)
        return STARG_ERROR_MEMORY;
    w->scene = scene;
    w->visit = starg_allocate_zero(context, faces, sizeof *w->visit);
    w->stack = starg_allocate(context, faces, sizeof *w->stack);
    if (w->visit == NULL || w->stack == NULL) {
        verify_watch_free(w);
        return STARG_ERROR_MEMORY;
    }
    *out = w;
    return STARG_OK;
}

void verify_watch_free(verify_watch *w) {
    if (w == NULL)
        return;
    RELEASE(w->met.data, w->visit, w->stack, w);
}

starg_status verify_watch_make(starg_context *context, void *shared, void **scratch) {
    verify_watch *watch;
    (void)context;
    starg_status status = verify_watch_create(shared, &watch);
    *scratch = watch;
    return status;
}

void verify_watch_drop(starg_context *context, void *scratch) {
    (void)context;
    verify_watch_free(scratch);
}

starg_status verify_scene_create(const verify_surface *surface, const verify_tree *tree,
                                 bool embedding, verify_scene *out) {
    *out = (verify_scene){.surface = surface, .tree = tree};
    TRY(verify_find_twins(surface, &out->twin));
    NEW(surface->context, "verify", out->outgoing, surface->vertex_count);
    for (size_t v = 0; v < surface->vertex_count; v++)
        out->outgoing[v] = UINT32_MAX;
    for (size_t e = 3 * surface->face_count; e-- > 0;)
        out->outgoing[surface->faces[e]] = (uint32_t)e;
    NEW_ZERO(surface->context, "verify", out->sound, surface->face_count);
    NEW_ZERO(surface->context, "verify", out->sound_about, surface->vertex_count);
    if (embedding) {
        TRY(verify_find_sound(out, out->sound, &out->embedded));
        memset(out->sound_about, 1, surface->vertex_count);
        for (size_t e = 0; e < 3 * surface->face_count; e++)
            if (!out->sound[e / 3])
                out->sound_about[surface->faces[e]] = 0;
    }
    return STARG_OK;
}

void verify_scene_free(verify_scene *scene) {
    RELEASE(scene->twin, scene->outgoing, scene->sound, scene->sound_about);
    *scene = (verify_scene){0};
}
