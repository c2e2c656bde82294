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
 * The BVH finds the triangles: boxes outside one of the planes of K are skipped, with a margin
 * above rounding. Cost O(log n) per face, times the triangles near its cone. */
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
} cone;

static void make_cone(cone *k) {
    double r[3][3], size = 0, blur = 0, range = k->scene->extent;
    for (int i = 0; i < 3; i++) {
        vec3_subtract(k->corner[i].place.at, k->p, r[i]);
        blur = fmax(blur, k->corner[i].place.blur);
        for (int j = 0; j < 3; j++)
            size = fmax(size, fabs(r[i][j]));
    }
    double blurred = 32 * blur * (size + blur) * range;
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

/* orient3d of p, two corners of the triangle and a vertex. */
static int lateral(const cone *k, int i, int j, const dyadic_point *q) {
    return dyadic_orient3d(&k->apex, &k->corner[i].place, &k->corner[j].place, q);
}

/* Is the vertex q in the closed cone, strictly before the plane of the face? */
static bool before_face(const cone *k, const dyadic_point *q) {
    const visibility_scene *scene = k->scene;
    return orient3d(scene_corner(scene, k->rank, 0), scene_corner(scene, k->rank, 1),
                    scene_corner(scene, k->rank, 2), q->at) > 0 &&
           lateral(k, 1, 0, q) >= 0 && lateral(k, 2, 1, q) >= 0 && lateral(k, 0, 2, q) >= 0;
}

/* Does the segment s t pass through the triangle of p and corners i and j, off the line of these?
 */
static bool crosses_lateral(const cone *k, int i, int j, const dyadic_point *s,
                            const dyadic_point *t) {
    const dyadic_point *a = &k->corner[i].place, *b = &k->corner[j].place;
    if (lateral(k, i, j, s) * lateral(k, i, j, t) >= 0)
        return false;
    int ab = dyadic_orient3d(s, t, a, b), pa = dyadic_orient3d(s, t, &k->apex, a);
    int bp = dyadic_orient3d(s, t, b, &k->apex);
    return ab != 0 && pa * ab >= 0 && bp * ab >= 0;
}

/* Is the vertex in `slot` corner i of the triangle? */
static bool is_corner(const cone *k, int i, uint32_t slot) {
    const uint32_t *support = k->corner[i % 3].support;
    return support[0] == slot && support[1] == SCENE_NONE;
}

/* Does the triangle, except corners shared with the face, lie beyond one of the planes? Its part on
 * that plane is then a corner or an edge of the face, which is not before it. */
static bool is_plainly_outside(const cone *k, size_t rank) {
    const uint32_t *other = k->scene->corners + 3 * rank;
    for (int i = 0; i < 4; i++) {
        int outside = 0;
        for (int j = 0; j < 3; j++) {
            uint32_t slot = other[j];
            bool shared = is_corner(k, i, slot) || (i < 3 && is_corner(k, i + 1, slot)) ||
                          (i == 3 && (is_corner(k, 1, slot) || is_corner(k, 2, slot)));
            double reach = k->offset[i] + k->normal[i][0] * (k->scene->x[slot] - k->p[0]) +
                           k->normal[i][1] * (k->scene->y[slot] - k->p[1]) +
                           k->normal[i][2] * (k->scene->z[slot] - k->p[2]);
            outside += shared || reach < -k->slack[i];
        }
        if (outside == 3)
            return true;
    }
    return false;
}

static bool is_clear_of(const cone *k, size_t rank) {
    if (scene_is_clear(k->scene, rank))
        return true;
    if (k->side != NULL && !scene_may_block(k->scene, rank, k->side[rank]))
        return true; /* by the proof in scene.h another face blocks the same view first */
    if (rank == k->rank || is_plainly_outside(k, rank))
        return true;
    dyadic_point t[3];
    for (int i = 0; i < 3; i++) {
        t[i] = dyadic_of(scene_corner(k->scene, rank, i));
        if (before_face(k, &t[i]))
            return false;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (crosses_lateral(k, i, (i + 1) % 3, &t[j], &t[(j + 1) % 3]))
                return false;
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
