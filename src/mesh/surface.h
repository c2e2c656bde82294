/* A closed surface that changes by edge collapses: halfedges with their twins. */
#ifndef STARG_MESH_SURFACE_H
#define STARG_MESH_SURFACE_H

#include <stdbool.h>

#include "mesh/mesh.h"
#include "mesh/topology.h"

/* Corners, halfedges and faces are numbered as in topology.h and keep their numbers; a dead face
 * has no twins. Edges are numbered by the first halfedge that they had. */
typedef struct mesh_surface {
    starg_context *context;
    size_t vertex_count, face_count, edge_count, component_count; /* of the input */
    size_t vertices_left, faces_left;
    double scale;        /* a power of two: the extent of the input times it is about 1 */
    double *vertices;    /* vertex_count x 3, current positions                         */
    uint32_t *faces;     /* face_count x 3                                              */
    uint32_t *twin;      /* per halfedge; TOPOLOGY_NONE in dead faces                   */
    uint32_t *edge;      /* per halfedge                                                */
    uint32_t *halfedge;  /* per edge one of its two, TOPOLOGY_NONE when it is gone      */
    uint32_t *outgoing;  /* per vertex a halfedge from it, TOPOLOGY_NONE when gone      */
    uint32_t *merged;    /* per vertex the one it was merged into, itself if it stands;
                            TOPOLOGY_NONE for a vertex of no face                       */
    uint32_t *component; /* per face                                                    */
    double *volume;      /* per component six times its signed volume, in scaled units  */
} mesh_surface;

/* A working copy of a closed, oriented 2-manifold. Errors: MESH (it is not; with indices), MEMORY.
 */
starg_status surface_create(starg_context *context, const starg_mesh *mesh, mesh_surface **out);
void surface_free(mesh_surface *surface);

/* Collapses an edge that satisfies the link condition (see collapse.h): the vertex at the end of
 * the halfedge is merged into the one at its start, which moves to `position`. */
void surface_collapse(mesh_surface *surface, uint32_t halfedge, const double position[3]);

static inline bool surface_face_lives(const mesh_surface *surface, uint32_t face) {
    return surface->twin[3 * (size_t)face] != TOPOLOGY_NONE;
}

static inline const double *surface_at(const mesh_surface *surface, uint32_t vertex) {
    return surface->vertices + 3 * (size_t)vertex;
}

/* The vertex at the end of a halfedge. */
static inline uint32_t surface_end(const mesh_surface *surface, uint32_t halfedge) {
    return surface->faces[corner_next(halfedge)];
}

/* The next halfedge from the same vertex, counter-clockwise seen from outside. */
static inline uint32_t surface_turn(const mesh_surface *surface, uint32_t halfedge) {
    return surface->twin[corner_previous(halfedge)];
}

/* out = (a - b) in scaled units */
static inline void surface_difference(const mesh_surface *surface, const double a[3],
                                      const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = (a[k] - b[k]) * surface->scale;
}

#endif
