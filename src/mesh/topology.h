/* SPDX-License-Identifier: Apache-2.0 */
/* Adjacency of faces across edges, and connected components. */
#pragma once

#include "geometry/intersect.h"
#include "mesh/mesh.h"

#define TOPOLOGY_NONE UINT32_MAX

/* Corner k of face f has number 3 f + k, which also denotes the halfedge from it to the next corner
 * of f. */
static inline uint32_t corner_next(uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline uint32_t corner_previous(uint32_t corner) {
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

typedef struct mesh_topology {
    starg_context *context;
    size_t vertex_count, face_count, edge_count;
    size_t component_count;
    /* The opposite halfedge on an edge of exactly two faces, otherwise TOPOLOGY_NONE. */
    uint32_t *twin;
    /* Cyclic chain of the faces on an edge: the next halfedge on the same edge. */
    uint32_t *ring;
    /* Component of each face, numbered by their lowest face. */
    uint32_t *component;
} mesh_topology;

/* Builds the tables in O(n log d) for vertices of degree d. Errors: MEMORY. */
starg_status topology_create(starg_context *context, const starg_mesh *mesh, mesh_topology **out)
    STARG_PRIVATE(topology_create);
void topology_free(mesh_topology *topology) STARG_PRIVATE(topology_free);
STARG_DROP(topology, mesh_topology)

/* Number of halfedges on the edge of `halfedge`. */
size_t topology_edge_faces(const mesh_topology *topology, uint32_t halfedge);

/* Number of faces connected to their own other side across manifold edges: they are one-sided, like
 * a Moebius strip. Errors: MEMORY. */
starg_status topology_count_one_sided(const mesh_topology *topology, const starg_mesh *mesh,
                                      size_t *count);

/* Disjoint sets over 0 .. count - 1 in a parent array of the caller. */
void sets_make(uint32_t *parent, size_t count) STARG_PRIVATE(sets_make);
uint32_t sets_find(uint32_t *parent, uint32_t item) STARG_PRIVATE(sets_find);
/* The smaller root becomes the root. */
void sets_join(uint32_t *parent, uint32_t a, uint32_t b) STARG_PRIVATE(sets_join);

/* Surfaces that touch themselves in edges and vertices that they share. */

/* topology_create, with twins also at edges of more than two faces: those with solid between them.
 * Faces without a partner have none. Errors: MEMORY. */
starg_status wings_create(starg_context *context, const starg_mesh *mesh, mesh_topology **out);

/* Joins the corners at each vertex across twins: sets over corners, whose root is the lowest. */
void wings_find_fans(const mesh_topology *topology, const starg_mesh *mesh, uint32_t *fan);

/* A copy of the mesh in which each fan but the first at a vertex has a copy of the vertex, behind
 * the others. *out is NULL if all vertices have one fan. Errors: MEMORY, RANGE. */
starg_status wings_part(starg_context *context, const starg_mesh *mesh, starg_mesh **out);

/* How two faces of a mesh meet. */

/* Contact of two triangles given by their corners; equal vertices are shared corners. Exact. */
triangle_contact faces_contact(const double *vertices, const uint32_t a[3], const uint32_t b[3]);
