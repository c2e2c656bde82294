/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the overlay of two triangulations of the sphere. */
#pragma once

#include "mesh/topology.h"

enum { OVERLAY_CORNERS = 6 }; /* of the intersection of two triangles, at most */

/* One of the two triangulations: a mesh whose faces are positive triangles on the sphere. */
typedef struct overlay_side {
    const starg_mesh *mesh; /* as given */
    uint32_t *faces;        /* the same, counter-clockwise seen from outside of the sphere */
    const double *directions;
    mesh_topology *topology; /* of `faces` */
} overlay_side;

/* A point of a surface: weights of the corners of an oriented face, each at least 0. */
typedef struct overlay_place {
    uint32_t face;
    double weight[3];
} overlay_place;

/* A vertex of the overlay: a vertex of either, of both, or a crossing of two edges. `key` are a
 * vertex (or OVERLAY_NONE) or an edge of each side, by its lower halfedge. */
#define OVERLAY_NONE   UINT64_MAX
#define OVERLAY_VERTEX (UINT64_C(1) << 40)
typedef struct overlay_node {
    uint64_t key[2];
    overlay_place place[2];
} overlay_node;

/* The intersection of a face of A and a face of B, a strictly convex polygon. */
typedef struct overlay_cell {
    uint32_t face[2];
    uint32_t count, corner[OVERLAY_CORNERS]; /* counter-clockwise nodes */
} overlay_cell;

typedef struct sphere_overlay {
    starg_context *context;
    overlay_side side[2];
    STARG_ARRAY(overlay_node) nodes;
    STARG_ARRAY(overlay_cell) cells;
} sphere_overlay;

/* Finds nodes and cells (overlay.c). Errors: MESH (a face folds), MEMORY, CANCELLED. */
starg_status overlay_create(starg_context *context, const starg_mesh *const meshes[2],
                            const double *const directions[2], sphere_overlay **out);
void overlay_free(sphere_overlay *own);
STARG_DROP(overlay, sphere_overlay)

/* Changes the directions of an embedding of A so that the faces of B, on the same vertices, are
 * positive as well, as far as it can (overlay_share.c). Errors: MEMORY, CANCELLED. */
starg_status overlay_share(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                           double *directions);

/* Moves nodes within their faces and along their edges so that the cells can be cut into triangles
 * about their first corners, exactly positive on both sides (overlay_room.c); *moved: any had to.
 * Errors: SOLVER (too thin for doubles), MEMORY, CANCELLED. */
starg_status overlay_make_room(sphere_overlay *own, bool *moved);
