/* SPDX-License-Identifier: Apache-2.0 */
/* The tetrahedral mesh under construction by a reader, and the reader's numbers. */
#include "tetra/io.h"

#include "core/memory.h"

static const char STAGE[] = STARG_MESH_FILE;

starg_status tet_builder_reserve(tet_builder *builder, size_t vertices, size_t tetrahedra) {
    starg_status status = STARG_OK;
    starg_context *context = builder->points.source->context;
    if (vertices > 0)
        STARG_TRY(starg_builder_reserve(&builder->points, vertices, 0));
    if (tetrahedra > 0) {
        void *corners =
            starg_reallocate(context, builder->tetrahedra.data, builder->tetrahedra.count,
                             4 * tetrahedra, sizeof *builder->tetrahedra.data);
        if (corners == NULL)
            return starg_fail_memory(context, STAGE);
        builder->tetrahedra.data = corners;
        builder->tetrahedra.capacity = 4 * tetrahedra;
    }
done:
    return status;
}

starg_status tet_builder_add(tet_builder *builder, const int64_t corners[4], int64_t region,
                             starg_place place) {
    starg_status status = STARG_OK;
    const starg_source *source = builder->points.source;
    for (int k = 0; k < 4; k++) {
        if (corners[k] < 0 || corners[k] > (int64_t)STARG_MESH_LIMIT)
            return starg_source_fail(
                source, place,
                "tetrahedron %zu has the impossible vertex %lld (both counted from 0)",
                tet_builder_count(builder), (long long)corners[k]);
        STARG_PUSH(source->context, STAGE, &builder->tetrahedra, (uint32_t)corners[k]);
    }
    STARG_PUSH(source->context, STAGE, &builder->regions, (int32_t)(uint32_t)(uint64_t)region);
done:
    return status;
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
    starg_context *context = builder->points.source->context;
    STARG_ARRAY_FREE(context, &builder->tetrahedra);
    STARG_ARRAY_FREE(context, &builder->regions);
    starg_release(context, builder->corners);
    starg_builder_free(&builder->points);
}

/* ---- numbers ---- */

starg_place tet_place(const tet_numbers *numbers) {
    if (numbers->encoding == TET_TEXT)
        return starg_at_line(numbers->scan.line);
    return starg_at_byte((size_t)(numbers->scan.at - numbers->scan.source->bytes));
}

static size_t type_bytes(tet_type type) {
    return type == TET_INT8 ? 1 : type == TET_INT32 || type == TET_FLOAT32 ? 4 : 8;
}

size_t tet_least_bytes(const tet_numbers *numbers, tet_type type) {
    return numbers->encoding == TET_TEXT ? 2 : type_bytes(type);
}

/* The next bytes as a 64-bit number, zero extended. */
static starg_status take_bits(tet_numbers *numbers, tet_type type, const char *what,
                              uint64_t *bits) {
    size_t size = type_bytes(type);
    if ((size_t)(numbers->scan.end - numbers->scan.at) < size)
        return starg_source_fail(numbers->scan.source, tet_place(numbers),
                                 "the file ends where %s is expected; it seems to be truncated",
                                 what);
    *bits = 0;
    for (size_t i = 0; i < size; i++) {
        size_t from = numbers->encoding == TET_LITTLE ? size - 1 - i : i;
        *bits = *bits << 8 | (unsigned char)numbers->scan.at[from];
    }
    numbers->scan.at += size;
    return STARG_OK;
}

static double decode_real(uint64_t bits, tet_type type) {
    double wide;
    float narrow;
    uint32_t half = (uint32_t)bits;
    if (type == TET_FLOAT64) {
        memcpy(&wide, &bits, sizeof wide);
        return wide;
    }
    memcpy(&narrow, &half, sizeof narrow);
    return (double)narrow;
}

starg_status tet_real(tet_numbers *numbers, tet_type type, const char *what, double *value) {
    uint64_t bits = 0;
    if (numbers->encoding == TET_TEXT)
        return starg_scan_real(&numbers->scan, what, value);
    starg_status status = take_bits(numbers, type, what, &bits);
    if (status == STARG_OK)
        *value = decode_real(bits, type);
    return status;
}

starg_status tet_integer(tet_numbers *numbers, tet_type type, const char *what, int64_t *value) {
    uint64_t bits = 0;
    if (numbers->encoding == TET_TEXT)
        return starg_scan_integer(&numbers->scan, what, value);
    starg_status status = take_bits(numbers, type, what, &bits);
    if (status != STARG_OK)
        return status;
    if (type == TET_INT8)
        *value = (int64_t)(bits ^ 0x80) - 0x80;
    else
        *value = type == TET_INT32 ? (int64_t)(int32_t)(uint32_t)bits : (int64_t)bits;
    return STARG_OK;
}

starg_status tet_check_count(const tet_numbers *numbers, int64_t count, size_t bytes,
                             const char *what) {
    /* the last number of a text needs no blank after it */
    size_t left = (size_t)(numbers->scan.end - numbers->scan.at) + 1;
    if (count >= 0 && (uint64_t)count <= left / bytes)
        return STARG_OK;
    return starg_source_fail(numbers->scan.source, tet_place(numbers),
                             "the file declares %lld %s, too many for the %zu bytes that follow; "
                             "the count is wrong or the file is truncated",
                             (long long)count, what, left - 1);
}
