/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of a planar straight-line graph. */
#pragma once

#include "core/memory.h"

/* Marks the outside of a hull edge. */
#define CONSTRAINED_NONE UINT32_MAX

/* Edge k runs from corner k to the next. */
typedef struct constrained_triangle {
    uint32_t corners[3]; /* counter-clockwise */
    uint32_t beyond[3];  /* the triangle across each edge, or NONE */
    int32_t turns[3];    /* winding number here minus that across the edge */
    bool fixed[3];       /* the edge belongs to the graph */
} constrained_triangle;

typedef STARG_ARRAY(constrained_triangle) constrained_triangles;

/* An edge of the graph. The winding number is higher by `turns` on its left than on its right. */
typedef struct constrained_edge {
    uint32_t from, to;
    int32_t turns;
} constrained_edge;

/* Triangulates the convex hull of the graph's vertices (endpoints of edges and `loose` ones) in the
 * plane of coordinates `u` and `v` of the points (x 3), with all edges of the graph; Delaunay up to
 * those and to rounding. Edges must be distinct. *done is false if the graph is not plane:
 * coincident vertices, crossing edges, or an edge through a vertex. With all vertices collinear
 * there are no triangles; *done is then true if no edge has turns. Errors: MEMORY. */
starg_status constrained_triangulate(starg_context *context, const double *points, int u, int v,
                                     const constrained_edge *edges, size_t edge_count,
                                     const uint32_t *loose, size_t loose_count,
                                     constrained_triangles *out, bool *done);
