/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether an edge of a surface can be collapsed to a point. */
#ifndef STARG_MESH_LEVELS_COLLAPSE_H
#define STARG_MESH_LEVELS_COLLAPSE_H

#include "mesh/levels/surface.h"
#include "mesh/repair/dynamic_bvh.h"

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

#endif
