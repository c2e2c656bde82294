/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles that fill what plane edges wind around. */
#ifndef STARG_STAR_STRICT_PARTITION_CAP_H
#define STARG_STAR_STRICT_PARTITION_CAP_H

#include "geometry/constrained.h"

typedef STARG_ARRAY(uint32_t) cap_indices;
typedef STARG_ARRAY(constrained_edge) cap_edges;

/* Coordinates along which points near a plane with that normal are seen counter-clockwise as
 * against the normal. */
void cap_choose_view(const double normal[3], int *u, int *v);

/* Vertices near a plane with the given normal, and edges between them, none twice: the winding
 * number on the left of an edge, as seen against the normal, is higher by its turns than on the
 * right. Appends triangles (counter-clockwise likewise) that fill the places of winding number 1;
 * all edges there are edges of triangles, and so are the vertices. *done is false when the edges
 * cross, or some place has another winding number than 0 and 1. Errors: MEMORY. */
starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const cap_edges *edges, const cap_indices *loose, cap_indices *triangles,
                      bool *done);

#endif
