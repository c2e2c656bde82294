/* SPDX-License-Identifier: Apache-2.0 */
/* Closed surface under edge collapses: halfedges with the positions, edge numbers and component
 * data that simplification needs. */
#pragma once

#include "mesh/halfedges.h"

/* An edge is numbered by its original first halfedge. */
typedef struct mesh_surface {
    starg_context *context;
    mesh_halfedges mesh;
    size_t vertex_count, face_count, edge_count, component_count; /* of the input */
    size_t vertices_left, faces_left;
    double scale;        /* a power of two that scales the input's extent to about 1 */
    double *vertices;    /* vertex_count x 3, current positions */
    uint32_t *edge;      /* per halfedge */
    uint32_t *halfedge;  /* per edge one of its halfedges, TOPOLOGY_NONE if removed */
    uint32_t *merged;    /* per vertex the one it was merged into, itself if it still exists;
                            TOPOLOGY_NONE for an isolated vertex */
    uint32_t *component; /* per face */
    double *volume;      /* per component: six times its signed volume, in scaled units */
} mesh_surface;

/* Creates a working copy of a closed, oriented 2-manifold. Errors: MESH (not such a mesh; with
 * indices), MEMORY. */
starg_status surface_create(starg_context *context, const starg_mesh *mesh, mesh_surface **out);
void surface_free(mesh_surface *surface);
STARG_DROP(surface, mesh_surface)

/* Collapses an edge that satisfies the link condition (see collapse.h): merges the vertex at the
 * end of the halfedge into the one at its start, which moves to `position`. */
void surface_collapse(mesh_surface *surface, uint32_t halfedge, const double position[3]);

static inline const double *surface_at(const mesh_surface *surface, uint32_t vertex) {
    return surface->vertices + 3 * (size_t)vertex;
}

/* The three corners of a face. */
static inline const uint32_t *surface_face(const mesh_surface *surface, size_t face) {
    return surface->mesh.corners.data + 3 * face;
}

/* out = (a - b) in scaled units */
static inline void surface_difference(const mesh_surface *surface, const double a[3],
                                      const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (a[k] - b[k]) * surface->scale;
}
