/* SPDX-License-Identifier: Apache-2.0 */
/* May an edge of a surface be collapsed to a point? */
#ifndef STARG_MESH_LEVELS_COLLAPSE_H
#define STARG_MESH_LEVELS_COLLAPSE_H

#include "mesh/levels/surface.h"
#include "mesh/repair/dynamic_bvh.h"

/* Vertices of more edges are left alone: what a collapse costs grows with the square. */
enum { COLLAPSE_DEGREE = 64 };

/* The surroundings of an edge: the faces about its ends that a collapse keeps, each by the
 * halfedge from the end that it has. */
typedef struct collapse_star {
    uint32_t halfedge;
    uint32_t a, b; /* its start, which stays, and its end */
    size_t count;
    uint32_t kept[2 * COLLAPSE_DEGREE];
} collapse_star;

/* Gathers the star; false when a collapse would change the topology (the link condition [Dey,
 * Edelsbrunner, Guha, Nekhayev 1999]) or make a vertex of more than COLLAPSE_DEGREE edges. */
bool collapse_gather(const mesh_surface *surface, uint32_t halfedge, collapse_star *star);

/* With the end at `position`: no face turns far or becomes a sliver, and the component keeps most
 * of its volume. In rounded arithmetic. */
bool collapse_keeps_shape(const mesh_surface *surface, const collapse_star *star,
                          const double position[3]);

/* With the end at `position`: the changed faces meet one another and all others in nothing but the
 * corners and edges that they share, and the surface sweeps over no other component. Exact. The
 * surface is the same afterwards. */
bool collapse_keeps_embedding(mesh_surface *surface, const dynamic_bvh *tree,
                              const collapse_star *star, const double position[3]);

#endif
