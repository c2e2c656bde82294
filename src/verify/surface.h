/* SPDX-License-Identifier: Apache-2.0 */
/* The surface of a model as it is checked: faces with neighbours, shells, parts, a tree of boxes.
 */
#pragma once

#include "core/memory.h"
#include "starguard/mesh.h"

/* ---- disjoint sets ---- */
/* parent[i] is another member of the set of i, or i if it is the lowest one. */

/* The lowest member of the set of i. */
static inline uint32_t verify_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void verify_join(uint32_t *parent, uint32_t i, uint32_t j) {
    uint32_t a = verify_root(parent, i), b = verify_root(parent, j);
    parent[a > b ? a : b] = a > b ? b : a;
}

/* ---- the verifier's model: a copy with oriented shells, and winding numbers (surface.c) ---- */

typedef struct verify_surface {
    starg_context *context;
    size_t vertex_count, face_count;
    const double *vertices;    /* of the mesh, which must outlive the surface, or own_vertices */
    uint32_t *faces;           /* counter-clockwise seen from outside of the solid */
    double lower[3], upper[3]; /* bounds of the vertices in use */

    /* of scenes (verify/sight.h) */
    int ambient;                        /* the winding number far away */
    size_t model_vertices, model_faces; /* copies, and those of obstacles, follow */
    uint8_t *clear;                     /* by face: 1 blocks no view; NULL: all block */
    double *importance;                 /* by face: how much its area counts; NULL: 1 each */
    size_t backs; /* above 0: face f of the model counts from either side, and face backs + f is its
                     back */
    struct verify_patches *patches; /* freed with it; NULL: faces are seen as they are */
    double *own_vertices;           /* freed with the surface */
} verify_surface;

/* Is the face a target? */
static inline bool verify_is_target(const verify_surface *surface, size_t face) {
    return surface->importance == NULL || surface->importance[face] > 0;
}

/* Checks that every edge has as many faces in both directions (after welding coincident vertices if
 * necessary), gives vertices at which faces are not all connected across edges a copy for each
 * further group, and orients shells. Errors: MESH, MEMORY, CANCELLED. */
starg_status verify_surface_create(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out);
/* Same with all shells facing outward, also those of cavities, or as given. */
typedef enum verify_facing { VERIFY_NESTED, VERIFY_OUTWARD, VERIFY_AS_GIVEN } verify_facing;
starg_status verify_surface_facing(starg_context *context, const starg_mesh *mesh,
                                   verify_facing facing, verify_surface **out);
/* The faces of any mesh, with coincident vertices welded; without checks or reorientation. */
starg_status verify_surface_welded(starg_context *context, const starg_mesh *mesh,
                                   verify_surface **out);
/* Same for arbitrary triangles, unchanged and without checks. Takes ownership of `faces`, a block
 * of the context, also on failure. Errors: MEMORY. */
starg_status verify_surface_wrap(starg_context *context, const double *vertices,
                                 size_t vertex_count, uint32_t *faces, size_t face_count,
                                 verify_surface **out);
void verify_surface_free(verify_surface *surface);
STARG_DROP(verify_surface, verify_surface)

/* By directed edge 3 f + k, from corner k of face f to the next: the opposite one. `surface` has
 * been checked. *twin is a block of the context. Errors: MEMORY. */
starg_status verify_find_twins(const verify_surface *surface, uint32_t **twin);

/* The corners of a face. */
static inline void verify_corners(const verify_surface *surface, size_t face, const double *t[3]) {
    for (size_t i = 0; i < 3; i++)
        t[i] = surface->vertices + 3 * (size_t)surface->faces[3 * face + i];
}

/* Winding number of `count` faces (NULL: all), which form a closed surface, about p; *on_surface: p
 * lies on one of them, and the number is undefined. Exact. */
int verify_winding(const verify_surface *surface, const uint32_t *faces, size_t count,
                   const double p[3], bool *on_surface);

/* ---- lengths and areas in doubles, in a unit near the size of the model (measure.c) ---- */
/* So that neither huge nor tiny coordinates overflow or underflow. They decide only claims with a
 * tolerance. */

/* The power of two that brings the model's extent to about 1. */
int verify_scale(const verify_surface *surface);

/* Generous bound on the displacement of a surface point by rounding of coordinates. */
double verify_rounding(const verify_surface *surface);

/* Of the bounds. */
double verify_diagonal(const verify_surface *surface);

/* Area of a face in units of 2^(-2 scale). */
double verify_area(const verify_surface *surface, size_t face, int scale);

/* Same for any triangle. */
double verify_triangle_area(const double a[3], const double b[3], const double c[3], int scale);

/* Area vector, doubled, outward: the normal of a face in the same units. */
void verify_normal(const verify_surface *surface, size_t face, int scale, double n[3]);

/* A sum of volumes of tetrahedra in units of 2^(-3 scale), and a bound on its rounding error. */
typedef struct verify_volume {
    double sum, rest, slack;
} verify_volume;

/* Adds a tetrahedron by its corners; an inverted one is negative. */
void verify_add_volume(verify_volume *own, const double *const t[4], int scale);

static inline double verify_volume_value(const verify_volume *own) {
    return own->sum + own->rest;
}

/* Does it match the claimed volume, up to a billionth, rounding, and `slack`? */
bool verify_same_volume(const verify_volume *own, double claimed, double slack);

/* Squared distance from p to a face, in units of 2^(-2 scale). */
double verify_squared_distance(const verify_surface *surface, size_t face, const double p[3],
                               int scale);

/* Distance from p to the nearest face, in the model's own unit. */
double verify_distance(const verify_surface *surface, const double p[3], size_t faces, int scale);

/* ---- boxes around faces, for queries near a point, in a box, along a segment (tree.c) ---- */

typedef struct verify_tree verify_tree;

/* `surface` must outlive the tree. Errors: MEMORY. */
starg_status verify_tree_create(const verify_surface *surface, verify_tree **out);
void verify_tree_free(verify_tree *tree);
STARG_DROP(verify_tree, verify_tree)

/* Called with a face; false ends the visit. */
typedef bool verify_visit(void *data, uint32_t face);

/* Visits every face whose bounds meet a closed box, in an order that depends only on the surface;
 * false if the visit was ended. */
bool verify_tree_visit(const verify_tree *tree, const double lower[3], const double upper[3],
                       verify_visit *visit, void *data);

/* Distance from p to the nearest face, rounded, in the model's own unit; infinite without faces. */
double verify_tree_distance(const verify_tree *tree, const double p[3], int scale);

/* Visits all faces that meet [p, q], and some others; false if the visit was ended. */
bool verify_tree_follow(const verify_tree *tree, const double p[3], const double q[3],
                        verify_visit *visit, void *data);

/* Does a face meet [p, q)? p lies on none. Exact. */
bool verify_tree_blocks(const verify_tree *tree, const double p[3], const double q[3]);

/* The surface of the tree. */
const verify_surface *verify_tree_surface(const verify_tree *tree);

/* verify_winding of all its faces, using only those near a segment (verify/winding.c). Exact. */
int verify_tree_winding(const verify_tree *tree, const double p[3], bool *on_surface);

/* ---- shells: components of a surface connected through edges of two faces (shells.c) ---- */

/* Finds shells as disjoint sets of faces: *parent (face_count) is a block of the context. Errors:
 * MEMORY. */
starg_status verify_find_shells(const verify_surface *surface, uint32_t **parent);

/* ---- parts of a model that do not see each other (parts.c) ---- */

/* By face, the part that it bounds, numbered by their lowest faces; *part is a block of the
 * context. The surface is that of a plain solid, and no point of this sees faces of two parts.
 * Errors: MEMORY, CANCELLED. */
starg_status verify_find_parts(const verify_surface *surface, const verify_tree *tree,
                               uint32_t **part);
