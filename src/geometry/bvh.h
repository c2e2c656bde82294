/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding volume hierarchy over the triangles of a mesh. Box tests only compare coordinates and
 * lose nothing to rounding; predicates decide at the leaves. */
#pragma once

#include "core/memory.h"

typedef struct bvh_box {
    double lower[3], upper[3];
} bvh_box;

static inline bool bvh_boxes_meet(const bvh_box *a, const bvh_box *b) {
    for (int k = 0; k < 3; k++)
        if (a->upper[k] < b->lower[k] || b->upper[k] < a->lower[k])
            return false;
    return true;
}

/* An inner node has count 0 and its children at `first` and `first` + 1; a leaf holds the
 * triangles order[first .. first + count - 1]. */
typedef struct bvh_node {
    bvh_box box;
    uint32_t first, count;
} bvh_node;

typedef struct bvh {
    starg_context *context;
    size_t node_count, triangle_count;
    bvh_node *nodes; /* root at 0 */
    uint32_t *order; /* triangle indices, leaf by leaf: a spatial order of the mesh */
    const double *vertices;
    const uint32_t *faces; /* borrowed: must outlive the tree */
} bvh;

/* Builds the tree. Errors: MEMORY. */
starg_status bvh_create(starg_context *context, const double *vertices, const uint32_t *faces,
                        size_t face_count, bvh **out) STARG_PRIVATE(bvh_create);
void bvh_free(bvh *tree) STARG_PRIVATE(bvh_free);
STARG_DROP(bvh, bvh)

/* Calls visit with the position in `order` of every triangle in the leaves that pass may_meet,
 * until it returns false; returns false exactly if visit did. may_meet may reject a box only if no
 * triangle inside matters. The other queries are special cases. */
typedef bool bvh_box_test(void *user, const bvh_box *box);
typedef bool bvh_visit_rank(void *user, size_t rank);
bool bvh_query(const bvh *tree, bvh_box_test *may_meet, void *test_user, bvh_visit_rank *visit,
               void *visit_user);

/* Calls visit for every triangle whose box meets `box`, in a fixed order, until it returns false.
 * Returns false exactly if visit did. */
typedef bool bvh_visit(void *user, uint32_t triangle);
bool bvh_query_box(const bvh *tree, const bvh_box *box, bvh_visit *visit, void *user);

/* Calls visit(a, b) once for each unordered pair of triangles whose boxes meet. */
typedef bool bvh_visit_pair(void *user, uint32_t a, uint32_t b);
bool bvh_query_pairs(const bvh *tree, bvh_visit_pair *visit, void *user);

/* Same, of one triangle with those of larger numbers. */
bool bvh_query_pairs_of(const bvh *tree, uint32_t triangle, bvh_visit_pair *visit, void *user);

/* Winding number of the mesh about p, and whether p lies on a triangle (the number is then
 * meaningless). Exact for closed meshes: a vertical line, symbolically perturbed off every edge. */
int bvh_winding(const bvh *tree, const double p[3], bool *on_surface) STARG_PRIVATE(bvh_winding);

/* Contribution of one triangle to the winding number about p: 1 where the upward line leaves
 * through it, -1 where it enters, 0 where it misses. */
int bvh_crossing(const bvh *tree, uint32_t triangle, const double p[3]);

/* Same about a point just beside p[0] in the triangle p: p[0] + e (p[1] - p[0]) + e^2 (p[2] - p[0])
 * for all small e > 0. Exact; 0 if that is on the triangle. */
int bvh_crossing_beside(const bvh *tree, uint32_t triangle, const double *const p[3]);

/* Is that point, beside a corner of a triangle p with area, on a triangle? 1: which faces the same
 * way as p, -1: the other way. Exact. */
int bvh_covers_beside(const bvh *tree, uint32_t triangle, const double *const p[3]);

/* Winding number of the mesh just behind a triangle with area, on its inner side, beside its corner
 * k. Exact for closed meshes. */
int bvh_winding_behind(const bvh *tree, uint32_t triangle, int k);

/* Calls visit with the position in `order` of every triangle in the leaves that the segment from p
 * to q may meet (a superset of those that it meets), until it returns false. Returns false exactly
 * if visit did. */
bool bvh_query_segment(const bvh *tree, const double p[3], const double q[3], bvh_visit_rank *visit,
                       void *user) STARG_PRIVATE(bvh_query_segment);

/* The same for any segment that is within `pad` of this one in each coordinate. */
bool bvh_query_near_segment(const bvh *tree, const double p[3], const double q[3], double pad,
                            bvh_visit_rank *visit, void *user);

/* Distance from p to the nearest triangle, rounded; infinity without triangles. */
double bvh_distance(const bvh *tree, const double p[3]) STARG_PRIVATE(bvh_distance);

/* The triangle nearest to p, as far as rounding tells; one of several. There must be some. */
uint32_t bvh_nearest_triangle(const bvh *tree, const double p[3])
    STARG_PRIVATE(bvh_nearest_triangle);

/* The point of the triangles nearest to p, rounded; p without triangles. */
void bvh_nearest(const bvh *tree, const double p[3], double out[3]) STARG_PRIVATE(bvh_nearest);

/* ---- winding number: inside and outside, even for surfaces with holes (winding.c) ---- */

/* Far-field approximation of a node. */
typedef struct winding_moment {
    double center[3], normal[3]; /* weighted by area; sum of area vectors */
    double radius;               /* of a ball about the centre that contains the node's triangles */
} winding_moment;

typedef struct winding_field {
    const bvh *tree;         /* borrowed */
    double origin[3], scale; /* moments are in units that give the surface about unit size */
    winding_moment *moments; /* one per node */
} winding_field;

/* Errors: MEMORY. */
starg_status winding_create(starg_context *context, const bvh *tree, winding_field *out);
void winding_free(winding_field *field);

/* Signed solid angle of all triangles seen from p over 4 pi: 1 inside a closed outward surface, 0
 * outside, fractional near holes. The approximation is off by about 0.01. */
double winding_number(const winding_field *field, const double p[3]);

/* ---- the same of eight boxes a node, for many single segments (sight_tree.c) ---- */

typedef struct sight_tree sight_tree;

/* Made from a tree, which must outlive it, for segments within a box that contains the tree.
 * Errors: MEMORY. */
starg_status sight_tree_create(starg_context *context, const bvh *tree, const bvh_box *all,
                               sight_tree **out);
void sight_tree_free(sight_tree *tree);
STARG_DROP(sight_tree, sight_tree)

/* Calls visit with the rank of every triangle that the segment p q may meet, those near p first as
 * far as boxes tell, until it returns false; returns false exactly if visit did. p and q lie in
 * the box. */
bool sight_tree_query(const sight_tree *tree, const double p[3], const double q[3],
                      bvh_visit_rank *visit, void *user);
