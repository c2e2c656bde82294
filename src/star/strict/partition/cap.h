/* SPDX-License-Identifier: Apache-2.0 */
/* Triangulates the region that edges in a plane enclose. */
#ifndef STARG_STAR_STRICT_PARTITION_CAP_H
#define STARG_STAR_STRICT_PARTITION_CAP_H

#include "geometry/constrained.h"

typedef STARG_ARRAY(uint32_t) cap_indices;
typedef STARG_ARRAY(constrained_edge) cap_edges;

/* Projection axes: points near a plane with this normal appear counter-clockwise when viewed
 * against the normal. */
void cap_choose_view(const double normal[3], int *u, int *v);

/* Takes vertices near a plane with the given normal, and distinct edges between them; viewed
 * against the normal, the winding number on the left of an edge exceeds that on the right by its
 * turns. Appends triangles (counter-clockwise in the same view) that fill the regions of winding
 * number 1; all edges and vertices there belong to triangles. *done is false if edges cross, or if
 * some region has a winding number other than 0 and 1. Errors: MEMORY. */
starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const cap_edges *edges, const cap_indices *loose, cap_indices *triangles,
                      bool *done);

#endif
