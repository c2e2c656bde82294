/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether an edge of a surface can be collapsed to a point. */
#pragma once

#include "geometry/vec3.h"
#include "mesh/repair/dynamic_bvh.h"

/* Quadric error metrics [Garland, Heckbert 1997]: weighted sum of squared distances to planes and
 * points, as a polynomial in the offset d from a reference point: d.Ad + 2 b.d + c. */

typedef struct quadric {
    double xx, xy, xz, yy, yz, zz; /* A */
    double b[3], c;
} quadric;

/* Adds a plane through the reference point; the length of `normal` is the weight. Adds the point
 * itself with `share` of the weight. */
static inline void quadric_add_plane(quadric *q, const double normal[3], double share) {
    double weight = vec3_length(normal);
    if (!(weight > 0))
        return;
    q->xx += normal[0] * normal[0] / weight + share * weight;
    q->xy += normal[0] * normal[1] / weight;
    q->xz += normal[0] * normal[2] / weight;
    q->yy += normal[1] * normal[1] / weight + share * weight;
    q->yz += normal[1] * normal[2] / weight;
    q->zz += normal[2] * normal[2] / weight + share * weight;
}

/* out = A d */
static inline void quadric_apply(const quadric *q, const double d[3], double out[3]) {
    out[0] = q->xx * d[0] + q->xy * d[1] + q->xz * d[2];
    out[1] = q->xy * d[0] + q->yy * d[1] + q->yz * d[2];
    out[2] = q->xz * d[0] + q->yz * d[1] + q->zz * d[2];
}

static inline double quadric_error(const quadric *q, const double d[3]) {
    double ad[3];
    quadric_apply(q, d, ad);
    return vec3_dot(d, ad) + 2 * vec3_dot(q->b, d) + q->c;
}

/* Moves the reference point by d. */
static inline void quadric_shift(quadric *q, const double d[3]) {
    double ad[3];
    quadric_apply(q, d, ad);
    q->c += vec3_dot(d, ad) + 2 * vec3_dot(q->b, d);
    vec3_along(q->b, 1, ad, q->b);
}

/* Adds a quadric with the same reference point. */
static inline void quadric_add(quadric *q, const quadric *other) {
    q->xx += other->xx;
    q->xy += other->xy;
    q->xz += other->xz;
    q->yy += other->yy;
    q->yz += other->yz;
    q->zz += other->zz;
    vec3_along(q->b, 1, other->b, q->b);
    q->c += other->c;
}

/* The offset of least error, A d = -b by root-free Cholesky decomposition; false if A is too close
 * to singular. */
static inline bool quadric_optimum(const quadric *q, double d[3]) {
    double least = 1e-10 * (q->xx + q->yy + q->zz);
    double p0 = q->xx, l1 = q->xy / p0, l2 = q->xz / p0;
    double p1 = q->yy - l1 * q->xy, m = q->yz - l2 * q->xy, l3 = m / p1;
    double p2 = q->zz - l2 * q->xz - l3 * m;
    if (!(p0 > least && p1 > least && p2 > least))
        return false;
    double y0 = -q->b[0], y1 = -q->b[1] - l1 * y0, y2 = -q->b[2] - l2 * y0 - l3 * y1;
    d[2] = y2 / p2;
    d[1] = y1 / p1 - l3 * d[2];
    d[0] = y0 / p0 - l1 * d[1] - l2 * d[2];
    return true;
}

/* Vertices of higher degree are not collapsed: the cost grows with its square. */
enum { COLLAPSE_DEGREE = 64 };

/* Neighbourhood of an edge: the faces around its ends that a collapse keeps, each given by its
 * halfedge from that end. */
typedef struct collapse_star {
    uint32_t halfedge;
    uint32_t a, b; /* start of the edge, which stays, and its end */
    size_t count;
    uint32_t kept[2 * COLLAPSE_DEGREE];
} collapse_star;

/* Gathers the star; false if a collapse would change the topology (the link condition [Dey,
 * Edelsbrunner, Guha, Nekhayev 1999]) or make a vertex of degree above COLLAPSE_DEGREE. */
bool collapse_gather(const mesh_surface *surface, uint32_t halfedge, collapse_star *star);

/* With the vertex at `position`: no face rotates far or becomes a sliver, and the component keeps
 * most of its volume. In rounded arithmetic. */
bool collapse_keeps_shape(const mesh_surface *surface, const collapse_star *star,
                          const double position[3]);

/* With the vertex at `position`: the changed faces meet one another and all others only in shared
 * corners and edges, and the surface sweeps over no other component. Exact. Leaves the surface
 * unchanged. */
bool collapse_keeps_embedding(mesh_surface *surface, const dynamic_bvh *tree,
                              const collapse_star *star, const double position[3]);
