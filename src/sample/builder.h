/* SPDX-License-Identifier: Apache-2.0 */
/* A mesh under construction: vertices are identified by keys, so that separate patches share the
 * vertices on their common borders. */
#ifndef STARG_SAMPLE_BUILDER_H
#define STARG_SAMPLE_BUILDER_H

#include "core/memory.h"
#include "mesh/mesh.h"
#include "sample/key_map.h"

/* All zero when empty, except for the context. */
typedef struct mesh_builder {
    starg_context *context;
    key_map names;
    STARG_ARRAY(double) positions; /* 3 for each vertex */
    STARG_ARRAY(uint32_t) faces;   /* 3 for each face */
} mesh_builder;

/* The vertex with `key`, created at `position` if there is none yet. Errors: MEMORY. */
starg_status builder_vertex(mesh_builder *builder, uint64_t key, const double position[3],
                            uint32_t *vertex);
starg_status builder_triangle(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c);
/* Two triangles, cut along a c. */
starg_status builder_quad(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
/* Makes the mesh; the builder must still be freed. */
starg_status builder_finish(mesh_builder *builder, starg_mesh **out);
void builder_free(mesh_builder *builder);

#endif
