/* SPDX-License-Identifier: Apache-2.0 */
#include "sample/builder.h"

static const char STAGE[] = "sample";

starg_status builder_vertex(mesh_builder *builder, uint64_t key, const double position[3],
                            uint32_t *vertex) {
    starg_status status = STARG_OK;
    bool added = false;
    STARG_TRY(key_map_add(builder->context, &builder->names, key, vertex, &added));
    if (added)
        for (int k = 0; k < 3; k++)
            STARG_PUSH(builder->context, STAGE, &builder->positions, position[k]);
done:
    return status;
}

starg_status builder_triangle(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c) {
    starg_status status = STARG_OK;
    STARG_PUSH(builder->context, STAGE, &builder->faces, a);
    STARG_PUSH(builder->context, STAGE, &builder->faces, b);
    STARG_PUSH(builder->context, STAGE, &builder->faces, c);
done:
    return status;
}

starg_status builder_quad(mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    starg_status status = builder_triangle(builder, a, b, c);
    return status != STARG_OK ? status : builder_triangle(builder, a, c, d);
}

starg_status builder_finish(mesh_builder *builder, starg_mesh **out) {
    return starg_mesh_create(builder->context, builder->positions.data,
                             builder->positions.count / 3, builder->faces.data,
                             builder->faces.count / 3, out);
}

void builder_free(mesh_builder *builder) {
    key_map_free(builder->context, &builder->names);
    STARG_ARRAY_FREE(builder->context, &builder->positions);
    STARG_ARRAY_FREE(builder->context, &builder->faces);
    *builder = (mesh_builder){.context = builder->context};
}
