/* SPDX-License-Identifier: Apache-2.0 */
/* Constrained triangulation of a planar straight-line graph. */
#ifndef STARG_GEOMETRY_CONSTRAINED_H
#define STARG_GEOMETRY_CONSTRAINED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/context.h"
#include "core/memory.h"

/* What lies beyond an edge of the hull. */
#define CONSTRAINED_NONE UINT32_MAX

/* Edge k runs from corner k to the next. */
typedef struct constrained_triangle {
    uint32_t corners[3]; /* counter-clockwise */
    uint32_t beyond[3];  /* the triangle across each edge, or NONE */
    int32_t turns[3];    /* by how much the winding number is higher here than beyond */
    bool fixed[3];       /* the edge is one of the graph */
} constrained_triangle;

typedef STARG_ARRAY(constrained_triangle) constrained_triangles;

/* An edge of the graph. The winding number on its left is higher by `turns` than on its right. */
typedef struct constrained_edge {
    uint32_t from, to;
    int32_t turns;
} constrained_edge;

/* Triangulates the hull of the graph's vertices (those of the edges and `loose` ones), as seen
 * along the axis across coordinates `u` and `v` of the points (x 3), such that every edge of the
 * graph is one of the triangulation, which is Delaunay up to that and to rounding. No edge comes
 * twice. *done is false when it is not a plane graph: two vertices at one place, edges that cross,
 * an edge through a vertex. Without three vertices off a line there are no triangles, which is done
 * well unless some edge has turns. Errors: MEMORY. */
starg_status constrained_triangulate(starg_context *context, const double *points, int u, int v,
                                     const constrained_edge *edges, size_t edge_count,
                                     const uint32_t *loose, size_t loose_count,
                                     constrained_triangles *out, bool *done);

#endif
