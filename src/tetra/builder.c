/* SPDX-License-Identifier: Apache-2.0 */
/* The tetrahedral mesh under construction by a reader, and the reader's numbers. */
#include "tetra/io.h"

static const char STAGE[] = STARG_MESH_FILE;

starg_status tet_builder_reserve(tet_builder *builder, size_t vertices, size_t tetrahedra) {
    starg_context *context = builder->points.source->context;
    if (vertices > 0)
        TRY(starg_builder_reserve(&builder->points, vertices, 0));
    if (tetrahedra > 0) {
        void *corners =
            starg_reallocate(context, builder->tetrahedra.data, builder->tetrahedra.count,
                             4 * tetrahedra, sizeof *builder->tetrahedra.data);
        if (corners == NULL)
            return starg_fail_memory(context, STAGE);
        builder->tetrahedra.data = corners;
        builder->tetrahedra.capacity = 4 * tetrahedra;
    }
    return STARG_OK;
}

starg_status tet_builder_add(tet_builder *builder, const int64_t corners[4], int64_t region,
                             starg_place place) {
    const starg_source *source = builder->points.source;
    for (int k = 0; k < 4; k++) {
        if (corners[k] < 0 || corners[k] > (int64_t)STARG_MESH_LIMIT)
            return starg_source_fail(
                source, place,
                "tetrahedron %zu has the impossible vertex %lld (both counted from 0)",
                tet_builder_count(builder), (long long)corners[k]);
        PUSH(source->context, STAGE, &builder->tetrahedra, (uint32_t)corners[k]);
    }
    PUSH(source->context, STAGE, &builder->regions, (int32_t)(uint32_t)(uint64_t)region);
    return STARG_OK;
}

starg_status tet_builder_refuse(tet_builder *builder, const char *what, starg_place place) {
    return starg_source_fail(
        builder->points.source, place,
        "the cells include %s; only four-vertex tetrahedra are supported, so split other cells",
        what);
}

starg_status tet_builder_check(const tet_builder *builder) {
    const starg_source *source = builder->points.source;
    size_t vertices = starg_builder_vertex_count(&builder->points);
    size_t count = tet_builder_count(builder);
    if (count == 0)
        return starg_source_fail(source, starg_at_file(), "the file has no tetrahedra");
    for (size_t i = 0; i < 4 * count; i++) {
        if (builder->tetrahedra.data[i] < vertices)
            continue;
        uint64_t tetrahedron = i / 4;
        return starg_fail_at(
            source->context, STARG_ERROR_FORMAT, STAGE, STARG_ELEMENT_TETRAHEDRON, &tetrahedron, 1,
            "'%s': tetrahedron %zu refers to vertex %u, but there are only %zu (counted from 0)",
            source->name, i / 4, builder->tetrahedra.data[i], vertices);
    }
    return STARG_OK;
}

starg_status tet_builder_finish(tet_builder *builder, starg_tetmesh **out) {
    starg_status status = tet_builder_check(builder);
    if (status == STARG_OK)
        status =
            tetmesh_adopt(builder->points.source->context, builder->points.vertices.data,
                          starg_builder_vertex_count(&builder->points), builder->tetrahedra.data,
                          tet_builder_count(builder), builder->regions.data, false, out);
    if (status == STARG_OK) {
        builder->points.vertices.data = NULL;
        builder->tetrahedra.data = NULL;
        builder->regions.data = NULL;
        (*out)->corners = builder->corners;
        builder->corners = NULL;
    }
    return status;
}

void tet_builder_free(tet_builder *builder) {
    RELEASE(builder->tetrahedra.data, builder->regions.data, builder->corners);
    starg_builder_free(&builder->points);
}
