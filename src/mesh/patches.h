/* SPDX-License-Identifier: Apache-2.0 */
/* What is to be seen of each face: all of it at once, or parts of it, or points.
 *
 * A *patch* is a triangle in a face, or a point of it. Its corners are points between the face's
 * vertices with weights that are whole multiples of 2^-PATCH_DEPTH (geometry/dyadic.h): those of a
 * triangle come from halving edges. Faces still block as a whole. Where a solid has patches, they
 * are the columns of visibility rows in place of faces, face by face. */
#pragma once

#include "geometry/dyadic.h"
#include "mesh/mesh.h"

enum { PATCH_DEPTH = 28, ALL_EDGES = 7, MOST_PATCHES = 10000000 };
#define PATCH_UNIT (UINT32_C(1) << PATCH_DEPTH)

/* Weights of a corner by the vertices of its face, in the order of the mesh; their sum is
 * PATCH_UNIT. */
typedef struct patch_corner {
    uint32_t weight[3];
} patch_corner;

typedef struct patch_triangle {
    patch_corner corner[3];
} patch_triangle;

/* A point that is no vertex, on an edge or inside a face: two or three vertices, ascending, and
 * their weights, above 0 and not all even. The last vertex of a point on an edge is UINT32_MAX. */
typedef struct patch_point {
    uint32_t vertex[3], weight[3];
    int depth; /* the sum of the weights is 2^depth */
} patch_point;

typedef struct mesh_patches {
    starg_context *context;
    size_t corners; /* of each patch: 3, or 1: a point of the face */
    size_t vertex_count;
    size_t *first;              /* by face, and one more: the number of its first patch */
    STARG_ARRAY(uint32_t) face; /* by patch */
    STARG_ARRAY(uint32_t)
    corner; /* `corners` a patch: a vertex, or vertex_count + number of a point */
    STARG_ARRAY(double) share; /* by patch, of the area of its face */
    STARG_ARRAY(patch_point) points;
    STARG_ARRAY(double) places; /* of the points, rounded, 3 each */
    uint32_t *slots;            /* number of a point + 1, or 0; open addressing */
    size_t slot_count;
} mesh_patches;

static inline patch_triangle patch_whole(void) {
    return (patch_triangle){{{{PATCH_UNIT, 0, 0}}, {{0, PATCH_UNIT, 0}}, {{0, 0, PATCH_UNIT}}}};
}

/* The edge that halving cuts, from corner k to the next: the longest of those with bit k in `among`
 * (ALL_EDGES), the first of equals. The
 * square of its length is computed in doubles from the weights: with (e1, e2) the difference of the
 * weights of corners 1 and 2, times 2^-PATCH_DEPTH, of e1 (b - a) + e2 (c - a). */
int patch_longest_edge(const patch_triangle *t, const double *const corner[3], unsigned among,
                       double *square);

/* Halves edge k; child 0 keeps its first end. False: the corners lie too close for that. */
bool patch_halve(const patch_triangle *t, int k, patch_triangle child[2]);

/* The point of a corner of a face, in the common form; false: *vertex of the mesh. */
bool patch_point_of(const uint32_t face[3], const patch_corner *corner, patch_point *point,
                    uint32_t *vertex);

dyadic_point patch_point_dyadic(const patch_point *point, const double *vertices);

/* Cuts each of the first `faces` faces until no edge of its parts is longer than `longest` (above
 * 0); other faces are a patch each. Where `other_side` (may be NULL) names an earlier face with the
 * opposite orientation, the patches are those, turned around. *out = NULL: no face is cut. Errors:
 * ARGUMENT (more than MOST_PATCHES), MEMORY. */
starg_status patches_divide(starg_context *context, const starg_mesh *mesh, size_t faces,
                            double longest, const uint32_t *other_side, mesh_patches **out);

/* A point of a face. */
typedef struct face_point {
    uint32_t face;
    patch_corner at;
} face_point;

typedef STARG_ARRAY(face_point) face_points;

/* By faces; for qsort and bsearch. */
int face_points_compare(const void *a, const void *b);

/* Adds the corners of the patches of a face. Errors: MEMORY. */
starg_status patches_list_corners(const mesh_patches *patches, const starg_mesh *mesh,
                                  uint32_t face, face_points *out);

/* Each point is a patch; sorts the points, and leaves one of equal ones. Backs, as above, have the
 * points of their fronts, and none of their own. Errors: MEMORY. */
starg_status patches_of_points(starg_context *context, const starg_mesh *mesh, face_points *points,
                               const uint32_t *other_side, mesh_patches **out);

/* How many that would be; stops counting above `most`. */
size_t patches_count(const starg_mesh *mesh, size_t faces, double longest, size_t most);

void patches_free(mesh_patches *patches);
STARG_DROP(patches, mesh_patches)

/* Corner k of a patch; a point has but one. */
static inline uint32_t patches_corner(const mesh_patches *patches, size_t patch, size_t k) {
    return patches->corner.data[patches->corners * patch + k % patches->corners];
}

/* The position of a corner of a patch, rounded. */
static inline const double *patches_place(const mesh_patches *patches, const starg_mesh *mesh,
                                          uint32_t corner) {
    return corner < patches->vertex_count
               ? mesh->vertices + 3 * (size_t)corner
               : patches->places.data + 3 * (corner - patches->vertex_count);
}
