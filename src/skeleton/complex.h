/* SPDX-License-Identifier: Apache-2.0 */
/* The medial axis as a cell complex: the part of the Voronoi diagram dual to what lies inside. */
#ifndef STARG_SKELETON_COMPLEX_H
#define STARG_SKELETON_COMPLEX_H

#include "geometry/delaunay.h"
#include "mesh/solid.h"

/* Delaunay tetrahedra inside the solid, their inner triangles, and their edges, are the duals of
 * Voronoi vertices, edges and facets. The names here are those of the dual: a node is a
 * tetrahedron, a link a triangle between two of them, a sheet an edge inside. */
typedef struct medial_complex {
    starg_context *context;
    size_t node_count, link_count, edge_count;
    uint32_t (*corners)[4]; /* sample points of each node's tetrahedron                        */
    double (*centres)[3];   /* circumcentre where that is inside, else a point of the tetrahedron */
    double *radii; /* distance from the centre to the surface; 0 for centres that rounding put
                      outside */
    uint32_t (*links)[2];      /* the two nodes of a link                                      */
    uint32_t (*link_edges)[3]; /* the edges of its triangle                                    */
    uint32_t (*ends)[2];       /* sample points of each edge                                   */
    double *lengths;           /* of edges                                                     */
    bool *sheet;               /* is the edge inside? Else it bounds the complex.              */
    uint32_t *first_link;      /* links of edge e: edge_links[first_link[e] .. first_link[e + 1]) */
    uint32_t *edge_links;
    size_t point_count;
    bool *buried; /* sample points without a triangle at the border: dual to cells of volume   */
} medial_complex;

/* Makes the complex of the tetrahedra that are inside. Errors: MEMORY, CANCELLED. */
starg_status complex_create(starg_context *context, const starg_solid *solid, const double *points,
                            size_t point_count, const delaunay *tetrahedra, const bool *inside,
                            medial_complex **out);
void complex_free(medial_complex *complex);

#endif
