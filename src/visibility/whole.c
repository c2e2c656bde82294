/* SPDX-License-Identifier: Apache-2.0 */
/* Is a face visible as a whole, not only at its corners?
 *
 * The view to the points of face f = (a, b, c) is blocked by a triangle t exactly if t has a point
 * in conv(p, f) outside f itself, that is in the cone K of p over f, strictly before the plane of
 * f. The intersection of t and K is a convex polygon; it has points strictly before the plane
 * exactly if one of its corners is. Such a corner is
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
    const double *corner[3];
    size_t rank;
    /* Planes with the cone on their positive side, relative to p: three lateral ones, and that of
     * the face (positive at p). */
    double normal[4][3], offset[4], slack[4];
} cone;

static void make_cone(cone *k) {
    double r[3][3], size = 0, range = k->scene->extent;
    for (int i = 0; i < 3; i++) {
        vec3_subtract(k->corner[i], k->p, r[i]);
        for (int j = 0; j < 3; j++)
            size = fmax(size, fabs(r[i][j]));
    }
    for (int i = 0; i < 3; i++) {
        /* a face seen from inside is clockwise */
        vec3_cross(r[i], r[(i + 1) % 3], k->normal[i]);
        k->offset[i] = 0;
        k->slack[i] = 128 * 0x1p-53 * size * size * range + 0x1p-1000;
    }
    double u[3], v[3];
    vec3_subtract(r[1], r[0], u);
    vec3_subtract(r[2], r[0], v);
    vec3_cross(v, u, k->normal[3]);
    k->offset[3] = -vec3_dot(k->normal[3], r[0]);
    k->slack[3] = 512 * 0x1p-53 * size * size * range + 0x1p-1000;
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

/* Is q in the closed cone, strictly before the plane of the face? */
static bool before_face(const cone *k, const double q[3]) {
    const double *a = k->corner[0], *b = k->corner[1], *c = k->corner[2];
    return orient3d(a, b, c, q) > 0 && orient3d(k->p, b, a, q) >= 0 &&
           orient3d(k->p, c, b, q) >= 0 && orient3d(k->p, a, c, q) >= 0;
}

/* Does the segment s t pass through the triangle (p, a, b), off the line a b? */
static bool crosses_lateral(const double p[3], const double a[3], const double b[3],
                            const double s[3], const double t[3]) {
    int at_s = orient3d(p, a, b, s), at_t = orient3d(p, a, b, t);
    if (at_s * at_t >= 0)
        return false;
    int ab = orient3d(s, t, a, b), pa = orient3d(s, t, p, a), bp = orient3d(s, t, b, p);
    return ab != 0 && pa * ab >= 0 && bp * ab >= 0;
}

/* Does the triangle, except corners shared with the face, lie beyond one of the planes? Its part on
 * that plane is then a corner or an edge of the face, which is not before it. */
static bool is_plainly_outside(const cone *k, size_t rank) {
    const uint32_t *own = k->scene->corners + 3 * k->rank, *other = k->scene->corners + 3 * rank;
    for (int i = 0; i < 4; i++) {
        int outside = 0;
        for (int j = 0; j < 3; j++) {
            uint32_t slot = other[j];
            bool shared = slot == own[i % 3] || (i < 3 && slot == own[(i + 1) % 3]) ||
                          (i == 3 && (slot == own[1] || slot == own[2]));
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

static bool passes(void *user, size_t rank) {
    const cone *k = user;
    if (k->side != NULL && k->scene->cull && k->side[rank] <= 0)
        return true; /* by the proof in scene.h another face blocks the same view first */
    if (rank == k->rank || is_plainly_outside(k, rank))
        return true;
    const double *t[3];
    for (int i = 0; i < 3; i++) {
        t[i] = scene_corner(k->scene, rank, i);
        if (before_face(k, t[i]))
            return false;
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (crosses_lateral(k->p, k->corner[i], k->corner[(i + 1) % 3], t[j], t[(j + 1) % 3]))
                return false;
    return true;
}

bool face_is_wholly_visible(const visibility_scene *scene, const double p[3], const int8_t *side,
                            size_t rank) {
    cone k = {.scene = scene, .p = p, .side = side, .rank = rank};
    for (int i = 0; i < 3; i++)
        k.corner[i] = scene_corner(scene, rank, i);
    make_cone(&k);
    return bvh_query(scene->solid->tree, box_may_meet, &k, passes, &k);
}
