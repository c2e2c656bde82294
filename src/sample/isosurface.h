/* SPDX-License-Identifier: Apache-2.0 */
/* Meshes the zero set of an implicit field by marching tetrahedra. */
#ifndef STARG_SAMPLE_ISOSURFACE_H
#define STARG_SAMPLE_ISOSURFACE_H

#include "sample/builder.h"
#include "sample/implicit.h"

/* Fills `builder` with a closed 2-manifold, outward oriented, from cells of side `spacing`; its
 * triangles may be thin. Errors: MEMORY, CANCELLED. */
starg_status isosurface_extract(const implicit_field *field, double spacing, mesh_builder *builder);

#endif
