/* SPDX-License-Identifier: Apache-2.0 */
/* Is a triangle in a face visible as a whole, not only at its corners?
 *
 * The view to the points of f = (a, b, c), a face or a part of one, is blocked by a triangle t
 * exactly if t has a point in conv(p, f) outside f itself, that is in the cone K of p over f,
 * strictly before the plane of f. The intersection of t and K is a convex polygon; it has points
 * strictly before the plane exactly if one of its corners is. Such a corner is
 * - a corner of t in K, or
 * - a point where an edge of t passes through a lateral face of K, or
 * - a point where a ray p a, p b, p c meets t: before the plane this would hide the corner of f.
 * So, the three corners of f being visible, t blocks exactly if a corner of t lies in K strictly
 * before the plane, or an edge of t properly crosses a lateral triangle, such as (p, a, b), off the
 * line a b. (An edge within a lateral plane has an end in K or crosses one of the rays.)
 *
 * The BVH finds the triangles. Boxes outside one of the planes of K are skipped, and triangles that
 * such a plane, or one through p and an edge of theirs, parts from K, with margins above rounding.
 * Cost O(log n) per face, times the triangles near its cone. */
#include <math.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "visibility/scene.h"

typedef struct cone {
    const visibility_scene *scene;
    const double *p;
    const int8_t *side; /* of p by rank, or NULL */
    const scene_point *corner;
    dyadic_point apex; /* p */
    size_t rank;       /* of the face that has the triangle */
    uint32_t blocker;  /* found by passes() */
    /* Planes with the cone on their positive side, relative to p: three lateral ones, and that of
     * the face (positive at p). */
    double normal[4][3], offset[4], slack[4];
    uint32_t on[4][3]; /* slots of the face's vertices on them, or SCENE_NONE */
    double ray[3][3];  /* from p to the corners, rounded */
    double blur;       /* of the corners: how far off they may be */
    double range;      /* from p to anything, but for a factor below 2 */
} cone;

static void add_vertex(uint32_t slot, uint32_t on[3], int *count) {
    bool known = slot == SCENE_NONE;
    for (int i = 0; i < *count; i++)
        known = known || on[i] == slot;
    if (!known)
        on[(*count)++] = slot;
}

/* Lateral plane i holds both ends of an edge of the face that has corners i and i + 1; else those
 * corners that are vertices. */
static void find_vertices_on(cone *k, int i) {
    const uint32_t *pair[2] = {k->corner[i].support, k->corner[(i + 1) % 3].support};
    uint32_t *on = k->on[i], all[3];
    int count = 0, single = 0;
    on[0] = on[1] = on[2] = SCENE_NONE;
    for (int c = 0; c < 2; c++)
        for (int j = 0; j < 3; j++)
            add_vertex(pair[c][j], all, &count);
    for (int c = 0; c < 2 && count > 2; c++)
        if (pair[c][1] == SCENE_NONE)
            on[single++] = pair[c][0];
    for (int j = 0; j < count && count <= 2; j++)
        on[j] = all[j];
}

static void make_cone(cone *k) {
    double(*r)[3] = k->ray, size = 0;
    k->blur = 0;
    for (int i = 0; i < 3; i++) {
        vec3_subtract(k->corner[i].place.at, k->p, r[i]);
        k->blur = fmax(k->blur, k->corner[i].place.blur);
        for (int j = 0; j < 3; j++)
            size = fmax(size, fabs(r[i][j]));
    }
    const double range = k->range = k->scene->extent + size;
    double blurred = 32 * k->blur * (size + k->blur) * range;
    for (int i = 0; i < 3; i++) {
        /* a face seen from inside is clockwise */
        vec3_cross(r[i], r[(i + 1) % 3], k->normal[i]);
        k->offset[i] = 0;
        k->slack[i] = 128 * 0x1p-53 * size * size * range + blurred + 0x1p-1000;
    }
    double u[3], v[3];
    vec3_subtract(r[1], r[0], u);
    vec3_subtract(r[2], r[0], v);
    vec3_cross(v, u, k->normal[3]);
    k->offset[3] = -vec3_dot(k->normal[3], r[0]);
    for (int i = 0; i < 3; i++) {
        find_vertices_on(k, i);
        k->on[3][i] = k->scene->corners[3 * k->rank + (size_t)i];
    }
    k->slack[3] = 512 * 0x1p-53 * size * size * range + 4 * blurred + 0x1p-1000;
}

/* Tests the corner of the box farthest along the normal. */
static bool box_may_meet(void *user, const bvh_box *box) {
    const cone *k = user;
    for (int i = 0; i < 4; i++) {
        double reach = k->offset[i];
        for (int j = 0; j < 3; j++) {
            double extreme = k->normal[i][j] > 0 ? box->upper[j] : box->lower[j];
            reach += k->normal[i][j] * (extreme - k->p[j]);
        }
        if (reach < -k->slack[i])
            return false;
    }
    return true;
}

/* The distance of a vertex beyond plane i, times the length of its normal, up to slack[i]. */
static double reach_of(const cone *k, int i, uint32_t slot) {
    return k->offset[i] + k->normal[i][0] * (k->scene->x[slot] - k->p[0]) +
           k->normal[i][1] * (k->scene->y[slot] - k->p[1]) +
           k->normal[i][2] * (k->scene->z[slot] - k->p[2]);
}

static bool is_on(const cone *k, int i, uint32_t slot) {
    const uint32_t *on = k->on[i];
    return slot == on[0] || slot == on[1] || slot == on[2];
}

/* Does the triangle, except vertices that lie on it as part of the face, lie beyond one of the
 * planes? Its part on that plane is then a corner or an edge of the face, which is not before it.
 */
static bool is_plainly_outside(const cone *k, const uint32_t slots[3]) {
    for (int i = 0; i < 4; i++) {
        int outside = 0;
        for (int j = 0; j < 3; j++)
            outside += is_on(k, i, slots[j]) || reach_of(k, i, slots[j]) < -k->slack[i];
        if (outside == 3)
            return true;
    }
    return false;
}

/* Does a plane through p and an edge of the triangle part it from the cone? Then they meet in p
 * alone. This leaves out the rest of a wall whose faces are flat but for rounding. */
static bool is_apart(const cone *k, const uint32_t slots[3]) {
    double r[3][3], size = 0;
    for (int j = 0; j < 3; j++) {
        r[j][0] = k->scene->x[slots[j]] - k->p[0];
        r[j][1] = k->scene->y[slots[j]] - k->p[1];
        r[j][2] = k->scene->z[slots[j]] - k->p[2];
        size = fmax(size, fmax(fabs(r[j][0]), fmax(fabs(r[j][1]), fabs(r[j][2]))));
    }
    const double slack = size * size * (128 * 0x1p-53 * k->range + 32 * k->blur) + 0x1p-1000;
    for (int j = 0; j < 3; j++) {
        double normal[3];
        vec3_cross(r[j], r[(j + 1) % 3], normal);
        const double own = vec3_dot(normal, r[(j + 2) % 3]), sign = own > 0 ? 1 : -1;
        bool apart = fabs(own) > slack;
        for (int i = 0; i < 3 && apart; i++)
            apart = sign * vec3_dot(normal, k->ray[i]) < -slack;
        if (apart)
            return true;
    }
    return false;
}

/* On which side of plane i is a vertex: 1 is that of the cone. */
static int side_of(const cone *k, int i, uint32_t slot, const dyadic_point *q) {
    const visibility_scene *scene = k->scene;
    if (is_on(k, i, slot))
        return 0;
    const double reach = reach_of(k, i, slot);
    if (fabs(reach) > k->slack[i])
        return reach > 0 ? 1 : -1;
    if (i < 3)
        return dyadic_orient3d(&k->apex, &k->corner[(i + 1) % 3].place, &k->corner[i].place, q);
    return orient3d(scene_corner(scene, k->rank, 0), scene_corner(scene, k->rank, 1),
                    scene_corner(scene, k->rank, 2), q->at);
}

/* Does the segment s t, whose ends are on different sides of lateral plane i, pass through the
 * triangle of p and two corners, off the line of these? */
static bool crosses_lateral(const cone *k, int i, const dyadic_point *s, const dyadic_point *t) {
    const dyadic_point *a = &k->corner[i].place, *b = &k->corner[(i + 1) % 3].place;
    int ab = dyadic_orient3d(s, t, a, b), pa = dyadic_orient3d(s, t, &k->apex, a);
    int bp = dyadic_orient3d(s, t, b, &k->apex);
    return ab != 0 && pa * ab >= 0 && bp * ab >= 0;
}

static bool is_clear_of(const cone *k, size_t rank) {
    const uint32_t *slots = k->scene->corners + 3 * rank;
    if (scene_is_clear(k->scene, rank))
        return true;
    if (k->side != NULL && !scene_may_block(k->scene, rank, k->side[rank]))
        return true; /* by the proof in scene.h another face blocks the same view first */
    if (rank == k->rank || is_plainly_outside(k, slots) || is_apart(k, slots))
        return true;
    dyadic_point t[3];
    int side[4][3];
    for (int i = 3; i >= 0; i--) {
        for (int j = 0; j < 3; j++) {
            t[j] = dyadic_of(scene_corner(k->scene, rank, j));
            side[i][j] = side_of(k, i, slots[j], &t[j]);
        }
        if (i == 3 && side[3][0] <= 0 && side[3][1] <= 0 && side[3][2] <= 0)
            return true; /* no part is before the face */
    }
    for (int j = 0; j < 3; j++)
        if (side[0][j] >= 0 && side[1][j] >= 0 && side[2][j] >= 0 && side[3][j] > 0)
            return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int next = (j + 1) % 3;
            if (side[i][j] * side[i][next] < 0 && (side[3][j] > 0 || side[3][next] > 0) &&
                crosses_lateral(k, i, &t[j], &t[next]))
                return false;
        }
    return true;
}

static bool passes(void *user, size_t rank) {
    cone *k = user;
    bool clear = is_clear_of(k, rank);
    if (!clear)
        k->blocker = (uint32_t)rank;
    return clear;
}

bool triangle_is_wholly_visible(const visibility_scene *scene, const double p[3],
                                const int8_t *side, size_t rank, const scene_point corner[3],
                                uint32_t *blocker) {
    cone k = {.scene = scene,
              .p = p,
              .side = side,
              .corner = corner,
              .apex = dyadic_of(p),
              .rank = rank,
              .blocker = SCENE_NONE};
    make_cone(&k);
    if (blocker != NULL && *blocker != SCENE_NONE && !is_clear_of(&k, *blocker))
        return false;
    bool clear = bvh_query(scene->solid->tree, box_may_meet, &k, passes, &k);
    if (blocker != NULL && !clear)
        *blocker = k.blocker;
    return clear;
}

bool patch_is_wholly_visible(const visibility_scene *scene, const double p[3], const int8_t *side,
                             size_t rank, size_t patch) {
    scene_point corner[3];
    const uint32_t *slots = scene_patch_corners(scene, patch);
    for (size_t k = 0; k < scene_patch_size(scene); k++)
        corner[k] = scene_point_at(scene, slots[k]);
    return scene_patch_size(scene) < 3 ||
           triangle_is_wholly_visible(scene, p, side, rank, corner, NULL);
}
