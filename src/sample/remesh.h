/* SPDX-License-Identifier: Apache-2.0 */
/* Turns the raw triangles of an isosurface into well-shaped ones, with a wanted vertex count. */
#ifndef STARG_SAMPLE_REMESH_H
#define STARG_SAMPLE_REMESH_H

#include "mesh/mesh.h"
#include "sample/implicit.h"

/* Coarsens `raw`, a closed 2-manifold on the zero set of `field`, to `vertex_count` vertices (more
 * if no further edge can be collapsed) and improves its triangles. Errors: MEMORY, CANCELLED. */
starg_status remesh_isosurface(starg_context *context, const implicit_field *field,
                               const starg_mesh *raw, size_t vertex_count, starg_mesh **out);

#endif
