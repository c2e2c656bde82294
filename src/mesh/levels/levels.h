/* SPDX-License-Identifier: Apache-2.0 */
/* A surface that is simplified by collapses of its edges. */
#pragma once

#include "geometry/bvh.h"
#include "mesh/halfedges.h"

/* ---- the closed surface: halfedges with positions, numbers, components (surface.c) ---- */

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

/* Collapses an edge that satisfies the link condition (collapse.c): merges the vertex at the
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

/* ---- bounding volume hierarchy over the faces of the changing surface (dynamic_bvh.c) ---- */

typedef struct dynamic_bvh {
    starg_context *context;
    const mesh_surface *surface;
    size_t listed;     /* faces when the tree was built */
    bvh *tree;         /* over copies of these faces */
    uint32_t *corners; /* listed x 3, read by the tree */
    uint32_t *face;    /* leaf by leaf */
    uint32_t *leaf;    /* per face of the surface */
    uint32_t *parent;  /* per node; the root's is itself */
} dynamic_bvh;

/* The surface is borrowed. Errors: MEMORY. */
starg_status dynamic_bvh_create(starg_context *context, const mesh_surface *surface,
                                dynamic_bvh **out);
void dynamic_bvh_free(dynamic_bvh *tree);
STARG_DROP(dynamic_bvh, dynamic_bvh)

/* Updates the tree after a face has moved. */
void dynamic_bvh_update(dynamic_bvh *tree, uint32_t face);
/* Takes a face out that a collapse is about to remove. */
void dynamic_bvh_remove(dynamic_bvh *tree, uint32_t face);
/* Rebuilds the tree once half of its faces are dead. Errors: MEMORY. */
starg_status dynamic_bvh_renew(dynamic_bvh *tree);

/* Calls visit for every living face whose box meets `box`, until it returns false. Returns false
 * exactly if visit did. */
bool dynamic_bvh_query(const dynamic_bvh *tree, const bvh_box *box, bvh_visit *visit, void *user);

static inline bvh_box dynamic_bvh_face_box(const mesh_surface *surface, const uint32_t corner[3]) {
    bvh_box box;
    const double *a = surface_at(surface, corner[0]), *b = surface_at(surface, corner[1]);
    const double *c = surface_at(surface, corner[2]);
    for (int k = 0; k < 3; k++) {
        double low = a[k] < b[k] ? a[k] : b[k], high = a[k] < b[k] ? b[k] : a[k];
        box.lower[k] = low < c[k] ? low : c[k];
        box.upper[k] = high > c[k] ? high : c[k];
    }
    return box;
}

/* ---- whether an edge of a surface can be collapsed to a point (collapse.c) ---- */

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
