/* SPDX-License-Identifier: Apache-2.0 */
/* A model at a standard level of detail. */
#ifndef STARG_SHAPE_LEVEL_H
#define STARG_SHAPE_LEVEL_H

#include "core/context.h"
#include "starguard/mesh.h"

/* The model without what is finer than about a mesh of `vertices` vertices can show: noise smoothed
 * out, no more vertices than that (or nearly, where the topology wants them), and where it met
 * itself locally, repaired. *out is NULL, which is no error, for a mesh that is not a closed and
 * oriented 2-manifold, and where nothing usable comes out: take it as it is. Errors: MEMORY,
 * CANCELLED, TIME. */
starg_status level_create(starg_context *context, const starg_mesh *mesh, size_t vertices,
                          starg_mesh **out);

#endif
