/* SPDX-License-Identifier: Apache-2.0 */
/* A model at a standard level of detail. */
#ifndef STARG_SHAPE_LEVEL_H
#define STARG_SHAPE_LEVEL_H

#include "core/context.h"
#include "starguard/mesh.h"

/* The model without detail finer than a mesh of `vertices` vertices can show: noise smoothed, at
 * most that many vertices (or nearly, if the topology needs more), local self-intersections
 * repaired. *out is NULL, without error, if the mesh is not a closed and oriented 2-manifold or
 * nothing usable results: use the mesh itself then. Errors: MEMORY, CANCELLED, TIME. */
starg_status level_create(starg_context *context, const starg_mesh *mesh, size_t vertices,
                          starg_mesh **out);

/* Without smoothing: a closed and oriented 2-manifold simplified and repaired. As above. */
starg_status level_coarsen(starg_context *context, const starg_mesh *mesh, size_t vertices,
                           starg_mesh **out);

#endif
