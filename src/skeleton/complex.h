/* SPDX-License-Identifier: Apache-2.0 */
/* The medial axis as a cell complex: the dual of the interior tetrahedra, a part of the Voronoi
 * diagram. */
#pragma once

#include "geometry/delaunay.h"
#include "mesh/solid.h"

/* Interior Delaunay tetrahedra, interior triangles and interior edges are dual to Voronoi vertices,
 * edges and facets. Names here: a node is a tetrahedron, or several whose centres coincide, a link
 * a triangle between two nodes, a sheet an interior edge. */
typedef struct medial_complex {
    starg_context *context;
    size_t tetrahedron_count, node_count, link_count, edge_count;
    uint32_t (*corners)[4]; /* sample points of each tetrahedron */
    uint32_t *node_of;      /* per tetrahedron */
    double (*centres)[3];   /* of nodes: circumcentre if inside, else a point of the tetrahedron */
    double
        *radii; /* distance from the centre to the surface; 0 if rounding put the centre outside */
    uint32_t (*links)[2];      /* the two nodes of a link */
    uint32_t (*link_edges)[3]; /* the edges of its triangle */
    uint32_t (*ends)[2];       /* sample points of each edge */
    double *lengths;           /* of edges */
    bool *sheet;               /* is the edge interior? Otherwise it bounds the complex */
    uint32_t *first_link;      /* links of edge e: edge_links[first_link[e] .. first_link[e + 1]) */
    uint32_t *edge_links;
    size_t point_count;
    bool *buried; /* sample points without a border triangle: dual to 3-cells */
} medial_complex;

/* Makes the complex of the interior tetrahedra. Errors: MEMORY, CANCELLED. */
starg_status complex_create(starg_context *context, const starg_solid *solid, const double *points,
                            size_t point_count, const delaunay *tetrahedra, const bool *inside,
                            medial_complex **out);
/* Makes the lists of links of edges anew, after links have been removed. */
void complex_invert(medial_complex *complex);
void complex_free(medial_complex *complex);
