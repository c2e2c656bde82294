/* SPDX-License-Identifier: Apache-2.0 */
/* Validity of an edge collapse.
 *
 * Topology: in a closed surface an edge satisfies the link condition if and only if its ends have
 * no common neighbours besides the two opposite corners, and the component is not a tetrahedron.
 * Then the surface stays a 2-manifold of the same genus.
 *
 * Embedding: only pairs with a changed face can start to intersect. Faces of the new star do not
 * intersect one another if the star projects injectively to a coordinate plane (the usual case,
 * decided by orient2d); otherwise all their pairs are tested. All other faces whose boxes meet
 * those of new faces are tested against these; their planes usually separate the two. The region
 * between the old and the new star is covered by the tetrahedra of the new position with the old
 * faces: another component that touches no new face is inside or outside as a whole, so testing one
 * of its points is enough. The component's volume shows whether it turns inside out. */
#include "mesh/levels/levels.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"

/* Cosine of the largest rotation of a normal. */
static const double LARGEST_TURN = 0.2;
/* Twice the area over the squared longest edge: faces below this are slivers. */
static const double SLIVER = 1e-3;
/* Fraction of its volume that a component must keep in a collapse. */
static const double LEAST_VOLUME = 0.5;

/* ---- topology ---- */

/* Appends the faces around the start of `first` that the collapse keeps; false if too many. */
static bool gather_end(const mesh_surface *s, uint32_t first, collapse_star *star) {
    uint32_t gone = star->halfedge / 3, other = halfedges_twin(&s->mesh, star->halfedge) / 3,
             h = first;
    size_t limit = star->count + COLLAPSE_DEGREE - 2;
    do {
        if (h / 3 != gone && h / 3 != other) {
            if (star->count == limit)
                return false;
            star->kept[star->count++] = h;
        }
        h = halfedges_turn(&s->mesh, h);
    } while (h != first);
    return true;
}

bool collapse_gather(const mesh_surface *s, uint32_t halfedge, collapse_star *star) {
    *star = (collapse_star){.halfedge = halfedge, .a = halfedges_start(&s->mesh, halfedge)};
    star->b = halfedges_end(&s->mesh, halfedge);
    if (!gather_end(s, halfedge, star))
        return false;
    size_t about_a = star->count;
    if (!gather_end(s, halfedges_twin(&s->mesh, halfedge), star) || star->count > COLLAPSE_DEGREE)
        return false;
    if (star->count < 3) /* a tetrahedron */
        return false;
    /* The kept faces of an end are in order: the first starts at one opposite corner, the last ends
     * at the other, and all corners between must belong to this end only. */
    return halfedges_common(&s->mesh, star->kept + 1, about_a - 1, star->kept + about_a + 1,
                            star->count - about_a - 1) == 0;
}

/* ---- shape ---- */

static double longest_squared(const double u[3], const double v[3]) {
    return fmax(fmax(vec3_dot(u, u), vec3_dot(v, v)), vec3_distance_squared(u, v));
}

/* Corners of a kept face, starting with its end; the second and third do not change. */
static void kept_corners(const mesh_surface *s, uint32_t halfedge, const double *corner[3]) {
    corner[0] = surface_at(s, halfedges_start(&s->mesh, halfedge));
    corner[1] = surface_at(s, halfedges_end(&s->mesh, halfedge));
    corner[2] = surface_at(s, halfedges_apex(&s->mesh, halfedge));
}

/* The normal of a face, computed at its first corner, and its quality relative to SLIVER. */
static double face_quality(const mesh_surface *s, const double first[3], const double *corner[3],
                           double normal[3]) {
    double u[3], v[3];
    surface_difference(s, corner[1], first, u);
    surface_difference(s, corner[2], first, v);
    vec3_cross(u, v, normal);
    double longest = longest_squared(u, v);
    return longest > 0 ? vec3_length(normal) / longest : 0;
}

/* Six times the volume between a face and the position. */
static double volume_below(const mesh_surface *s, uint32_t halfedge, const double position[3]) {
    const double *corner[3];
    double p[3][3];
    kept_corners(s, halfedge, corner);
    for (int k = 0; k < 3; k++)
        surface_difference(s, corner[k], position, p[k]);
    return vec3_triple(p[0], p[1], p[2]);
}

static bool keeps_volume(const mesh_surface *s, const collapse_star *star,
                         const double position[3]) {
    double before = s->volume[s->component[star->halfedge / 3]];
    double lost = volume_below(s, star->halfedge, position) +
                  volume_below(s, halfedges_twin(&s->mesh, star->halfedge), position);
    for (size_t i = 0; i < star->count; i++)
        lost += volume_below(s, star->kept[i], position);
    double after = before - lost;
    return before >= 0 ? after >= LEAST_VOLUME * before : after <= LEAST_VOLUME * before;
}

bool collapse_keeps_shape(const mesh_surface *s, const collapse_star *star,
                          const double position[3]) {
    double worst_before = INFINITY, worst_after = INFINITY;
    for (size_t i = 0; i < star->count; i++) {
        const double *corner[3];
        double before[3], after[3];
        kept_corners(s, star->kept[i], corner);
        worst_before = fmin(worst_before, face_quality(s, corner[0], corner, before));
        worst_after = fmin(worst_after, face_quality(s, position, corner, after));
        double turn = vec3_dot(before, after);
        if (turn < LARGEST_TURN * vec3_length(before) * vec3_length(after))
            return false;
    }
    return worst_after > 0 && worst_after >= fmin(worst_before, SLIVER) &&
           keeps_volume(s, star, position);
}

/* ---- embedding ---- */

/* Data for tests against nearby faces. */
typedef struct change {
    const mesh_surface *surface; /* with vertex a at its new position */
    const collapse_star *star;
    double old[3];  /* where a was */
    int axis, sign; /* dominant axis of the star's normal, and its sign */
    bvh_box box;    /* of the old and the new star */
    uint32_t corner[2 * COLLAPSE_DEGREE][3];
    bvh_box face_box[2 * COLLAPSE_DEGREE];
} change;

static void extend(bvh_box *box, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        box->lower[k] = fmin(box->lower[k], p[k]);
        box->upper[k] = fmax(box->upper[k], p[k]);
    }
}

static void find_axis(change *c) {
    double sum[3] = {0};
    for (size_t i = 0; i < c->star->count; i++) {
        const double *corner[3];
        double normal[3];
        kept_corners(c->surface, c->star->kept[i], corner);
        face_quality(c->surface, surface_at(c->surface, c->star->a), corner, normal);
        vec3_along(sum, 1, normal, sum);
    }
    c->axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(sum[k]) > fabs(sum[c->axis]))
            c->axis = k;
    c->sign = sum[c->axis] < 0 ? -1 : 1;
}

static void describe(change *c) {
    const mesh_surface *s = c->surface;
    const collapse_star *star = c->star;
    for (int k = 0; k < 3; k++)
        c->box.lower[k] = c->box.upper[k] = c->old[k];
    extend(&c->box, surface_at(s, star->a));
    extend(&c->box, surface_at(s, star->b));
    for (size_t i = 0; i < star->count; i++) {
        c->corner[i][0] = star->a;
        c->corner[i][1] = halfedges_end(&s->mesh, star->kept[i]);
        c->corner[i][2] = halfedges_apex(&s->mesh, star->kept[i]);
        c->face_box[i] = dynamic_bvh_face_box(s, c->corner[i]);
        extend(&c->box, surface_at(s, c->corner[i][1]));
    }
    find_axis(c);
}

static bool is_corner(uint32_t vertex, const uint32_t face[3]) {
    return vertex == face[0] || vertex == face[1] || vertex == face[2];
}

/* Are all corners of face v that are not corners of u strictly on one side of u's plane? */
static bool beside(const mesh_surface *s, const uint32_t u[3], const uint32_t v[3]) {
    int side = 0;
    for (int k = 0; k < 3; k++) {
        if (is_corner(v[k], u))
            continue;
        int at = orient3d(surface_at(s, u[0]), surface_at(s, u[1]), surface_at(s, u[2]),
                          surface_at(s, v[k]));
        if (at == 0 || at == -side)
            return false;
        side = at;
    }
    return side != 0;
}

/* Does some edge of u, projected along `axis`, have u on one side and all corners of v except its
 * own ends strictly on the other? Then they meet at most in those ends. This decides flat parts,
 * where planes do not separate. */
static bool apart_across(const mesh_surface *s, const uint32_t u[3], const uint32_t v[3],
                         int axis) {
    int p = (axis + 1) % 3, q = (axis + 2) % 3;
    int turn = orient2d(surface_at(s, u[0]), surface_at(s, u[1]), surface_at(s, u[2]), p, q);
    for (int k = 0; k < 3 && turn != 0; k++) {
        uint32_t from = u[k], to = u[(k + 1) % 3];
        bool apart = true;
        for (int j = 0; j < 3 && apart; j++)
            apart =
                v[j] == from || v[j] == to ||
                turn * orient2d(surface_at(s, from), surface_at(s, to), surface_at(s, v[j]), p, q) <
                    0;
        if (apart)
            return true;
    }
    return false;
}

/* Do two faces with area meet beyond their common corners and edge? The axis is a hint. */
static bool faces_meet(const mesh_surface *s, const uint32_t u[3], const uint32_t v[3], int axis) {
    if (apart_across(s, u, v, axis) || beside(s, u, v) || apart_across(s, v, u, axis) ||
        beside(s, v, u))
        return false;
    triangle_contact contact = faces_contact(s->vertices, u, v);
    return contact == TRIANGLES_TOUCH || contact == TRIANGLES_CROSS;
}

/* Does the new star project injectively along its axis? All its faces turn the same way there, and
 * the ring crosses a half-line from the centre along coordinate u once. */
static bool projects(const change *c) {
    int sign = c->sign, u = (c->axis + 1) % 3, v = (c->axis + 2) % 3, turns = 0;
    const double *middle = surface_at(c->surface, c->star->a);
    for (size_t i = 0; i < c->star->count; i++) {
        const double *p = surface_at(c->surface, c->corner[i][1]);
        const double *q = surface_at(c->surface, c->corner[i][2]);
        if (sign * orient2d(middle, p, q, u, v) <= 0)
            return false;
        bool before = sign > 0 ? p[v] > middle[v] : p[v] < middle[v];
        bool after = sign > 0 ? q[v] > middle[v] : q[v] < middle[v];
        turns += !before && after;
    }
    return turns == 1;
}

static bool star_is_embedded(const change *c) {
    if (projects(c))
        return true;
    const mesh_surface *s = c->surface;
    for (size_t i = 0; i < c->star->count; i++) {
        const uint32_t *u = c->corner[i];
        if (collinear(surface_at(s, u[0]), surface_at(s, u[1]), surface_at(s, u[2])))
            return false;
        for (size_t j = 0; j < i; j++)
            if (faces_meet(s, u, c->corner[j], c->axis))
                return false;
    }
    return true;
}

/* Is p in the tetrahedron of the new position and an old face? False if that is flat. */
static bool sweeps(const change *c, uint32_t face, const double p[3]) {
    const double *t[4];
    for (size_t k = 0; k < 3; k++) {
        uint32_t vertex = surface_face(c->surface, face)[k];
        t[k] = vertex == c->star->a ? c->old : surface_at(c->surface, vertex);
    }
    t[3] = surface_at(c->surface, c->star->a);
    int turn = orient3d(t[0], t[1], t[2], t[3]);
    return turn != 0 && turn * orient3d(p, t[1], t[2], t[3]) >= 0 &&
           turn * orient3d(t[0], p, t[2], t[3]) >= 0 && turn * orient3d(t[0], t[1], p, t[3]) >= 0 &&
           turn * orient3d(t[0], t[1], t[2], p) >= 0;
}

static bool is_swept(const change *c, const double p[3]) {
    const collapse_star *star = c->star;
    if (sweeps(c, star->halfedge / 3, p) ||
        sweeps(c, halfedges_twin(&c->surface->mesh, star->halfedge) / 3, p))
        return true;
    for (size_t i = 0; i < star->count; i++)
        if (sweeps(c, star->kept[i] / 3, p))
            return true;
    return false;
}

/* Visits a nearby face: false, which ends the search, if it intersects. */
static bool clear_of(void *user, uint32_t face) {
    const change *c = user;
    const mesh_surface *s = c->surface;
    const uint32_t *corner = surface_face(s, face);
    if (is_corner(c->star->a, corner) || is_corner(c->star->b, corner))
        return true;
    bvh_box box = dynamic_bvh_face_box(s, corner);
    for (size_t i = 0; i < c->star->count; i++)
        if (bvh_boxes_meet(&box, &c->face_box[i]) && faces_meet(s, c->corner[i], corner, c->axis))
            return false;
    return s->component[face] == s->component[c->star->halfedge / 3] ||
           !is_swept(c, surface_at(s, corner[0]));
}

bool collapse_keeps_embedding(mesh_surface *surface, const dynamic_bvh *tree,
                              const collapse_star *star, const double position[3]) {
    change c = {.surface = surface, .star = star};
    double *a = surface->vertices + 3 * (size_t)star->a;
    vec3_copy(a, c.old);
    vec3_copy(position, a);
    describe(&c);
    bool clear = star_is_embedded(&c) && dynamic_bvh_query(tree, &c.box, clear_of, &c);
    vec3_copy(c.old, a);
    return clear;
}
