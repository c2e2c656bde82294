/* SPDX-License-Identifier: Apache-2.0 */
/* The mesh under construction by a reader, and messages that name a place in its file. Counts and
 * indices are checked on arrival, so that `finish` cannot reject the contents. */
#include <math.h>
#include <stdarg.h>

#include "mesh/formats/io.h"

/* Larger concave polygons are refused: ear clipping is quadratic. */
enum { MAX_CONCAVE_CORNERS = 4096 };

/* Items between two checks of the clock and the cancellation flag; a power of two. */
enum { TICKS = 1 << 14 };

/* "'cube.off', line 7: " */
static void describe_place(const starg_source *source, starg_place place, char *text, size_t size) {
    if (place.element == STARG_ELEMENT_LINE)
        snprintf(text, size, "'%s', line %zu", source->name, place.at);
    else if (place.element == STARG_ELEMENT_BYTE)
        snprintf(text, size, "'%s', byte %zu", source->name, place.at);
    else
        snprintf(text, size, "'%s'", source->name);
}

starg_status starg_source_fail(const starg_source *source, starg_place place, const char *format,
                               ...) {
    char where[320], what[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    describe_place(source, place, where, sizeof where);
    uint64_t at = place.at;
    return starg_fail_at(source->context, STARG_ERROR_FORMAT, STARG_MESH_FILE, place.element, &at,
                         place.element != STARG_ELEMENT_NONE, "%s: %s", where, what);
}

starg_status starg_builder_reserve(starg_mesh_builder *builder, size_t vertices, size_t faces) {
    starg_context *context = builder->source->context;
    RESERVE(context, STARG_MESH_FILE, &builder->vertices, 3 * vertices);
    RESERVE(context, STARG_MESH_FILE, &builder->faces, 3 * faces);
    return STARG_OK;
}

static starg_status fail_range(starg_mesh_builder *builder, size_t axis, double value,
                               starg_place place) {
    char where[320];
    describe_place(builder->source, place, where, sizeof where);
    uint64_t vertex = starg_builder_vertex_count(builder);
    return starg_fail_at(builder->source->context, STARG_ERROR_RANGE, STARG_MESH_FILE,
                         STARG_ELEMENT_VERTEX, &vertex, 1,
                         "%s: coordinate %c of vertex %zu is %g; coordinates must be finite and "
                         "below 1e100 in magnitude",
                         where, "xyz"[axis], (size_t)vertex, value);
}

starg_status starg_builder_vertex(starg_mesh_builder *builder, const double point[3],
                                  starg_place place) {
    for (size_t k = 0; k < 3; k++)
        if (!(fabs(point[k]) < STARG_COORDINATE_LIMIT)) /* also true for NaN */
            return fail_range(builder, k, point[k], place);
    for (size_t k = 0; k < 3; k++)
        PUSH(builder->source->context, STARG_MESH_FILE, &builder->vertices, point[k]);
    return STARG_OK;
}

starg_status starg_builder_color(starg_mesh_builder *builder, const double color[3], double most) {
    for (int k = 0; k < 3; k++) {
        double part = fmax(0, fmin(1, color[k] / most)); /* of NaN: 0 */
        PUSH(builder->source->context, STARG_MESH_FILE, &builder->colors,
             (uint8_t)lround(255 * part));
    }
    return STARG_OK;
}

/* In single precision: what is beyond its range, or no number, is 0. */
static float texture_part(double part) {
    return fabs(part) < 1e30 ? (float)part : 0;
}

starg_status starg_builder_vertex_texture(starg_mesh_builder *builder, const double uv[2]) {
    for (int k = 0; k < 2; k++)
        PUSH(builder->source->context, STARG_MESH_FILE, &builder->vertex_texture,
             texture_part(uv[k]));
    return STARG_OK;
}

starg_status starg_builder_corner_texture(starg_mesh_builder *builder, const double uv[2]) {
    for (int k = 0; k < 2; k++)
        PUSH(builder->source->context, STARG_MESH_FILE, &builder->open_texture,
             texture_part(uv[k]));
    return STARG_OK;
}

void starg_builder_restart(starg_mesh_builder *builder) {
    builder->vertices.count = builder->faces.count = builder->corners.count = 0;
    builder->colors.count = builder->vertex_texture.count = builder->open_texture.count =
        builder->texture.count = 0;
    if (builder->values != NULL)
        builder->values->data.count = 0;
}

starg_status starg_builder_corner(starg_mesh_builder *builder, int64_t vertex, starg_place place) {
    size_t count = starg_builder_vertex_count(builder);
    if (vertex < 0 || (uint64_t)vertex >= count || vertex > UINT32_MAX)
        return starg_source_fail(
            builder->source, place,
            "a face refers to vertex %lld (counted from 0), but there are only %zu vertices",
            (long long)vertex, count);
    PUSH(builder->source->context, STARG_MESH_FILE, &builder->corners, (uint32_t)vertex);
    return STARG_OK;
}

/* Room for `count` more face indices. */
static starg_status make_room(starg_mesh_builder *builder, size_t count) {
    size_t needed = builder->faces.count + count;
    if (needed <= builder->faces.capacity)
        return STARG_OK;
    size_t capacity = needed > 2 * builder->faces.capacity ? needed : 2 * builder->faces.capacity;
    RESERVE(builder->source->context, STARG_MESH_FILE, &builder->faces, capacity);
    return STARG_OK;
}

/* Gives the corners of the open face's triangles their texture coordinates, if all its corners have
 * some: those of the first corner at the vertex. */
static starg_status texture_triangles(starg_mesh_builder *builder, const uint32_t *triangles) {
    const uint32_t *corners = builder->corners.data;
    size_t count = builder->corners.count;
    bool complete = builder->open_texture.count == 2 * count &&
                    builder->texture.count == 2 * builder->faces.count &&
                    count <= MAX_CONCAVE_CORNERS;
    for (size_t i = 0; complete && i < 3 * (count - 2); i++) {
        size_t at = 0;
        while (corners[at] != triangles[i])
            at++;
        for (size_t k = 0; k < 2; k++)
            PUSH(builder->source->context, STARG_MESH_FILE, &builder->texture,
                 builder->open_texture.data[2 * at + k]);
    }
    if (builder->open_texture.count > 0)
        builder->left_out |= complete ? 0 : STARG_MESH_TEXTURE;
    builder->open_texture.count = 0;
    return STARG_OK;
}

starg_status starg_builder_face(starg_mesh_builder *builder, starg_place place) {
    const uint32_t *corners = builder->corners.data;
    size_t count = builder->corners.count;
    if (count < 3)
        return starg_source_fail(builder->source, place,
                                 "a face has %zu corner%s; it needs at least 3", count,
                                 count == 1 ? "" : "s");
    TRY(make_room(builder, 3 * (count - 2)));
    uint32_t *triangles = builder->faces.data + builder->faces.count;
    if (!starg_polygon_fan(builder->vertices.data, corners, count, triangles)) {
        if (count > MAX_CONCAVE_CORNERS)
            return starg_source_fail(
                builder->source, place,
                "a nonconvex face has %zu corners, more than the limit of %d; triangulate it first",
                count, MAX_CONCAVE_CORNERS);
        TRY(starg_polygon_clip(builder->source->context, builder->vertices.data, corners, count,
                               triangles));
    }
    TRY(texture_triangles(builder, triangles));
    builder->faces.count += 3 * (count - 2);
    builder->corners.count = 0;
    while (builder->values != NULL && builder->values->data.count < builder->faces.count / 3)
        PUSH(builder->source->context, STARG_MESH_FILE, &builder->values->data,
             builder->values->current);
    return STARG_OK;
}

starg_status starg_builder_tick(starg_mesh_builder *builder, size_t done) {
    if (++builder->ticks % TICKS != 0)
        return STARG_OK;
    starg_progress_step(builder->source->context, done, builder->source->size);
    return starg_check_cancel(builder->source->context, STARG_MESH_FILE);
}

/* Texture coordinates of vertices, at their corners. */
static starg_status spread_texture(starg_mesh_builder *builder) {
    if (builder->vertex_texture.count == 0 || builder->texture.count > 0)
        return STARG_OK;
    for (size_t i = 0; i < 2 * builder->faces.count; i++)
        PUSH(builder->source->context, STARG_MESH_FILE, &builder->texture,
             builder->vertex_texture.data[2 * (size_t)builder->faces.data[i / 2] + i % 2]);
    return STARG_OK;
}

starg_status starg_builder_finish(starg_mesh_builder *builder, starg_mesh **out) {
    if (builder->faces.count == 0)
        return starg_source_fail(builder->source, starg_at_file(),
                                 "the file has no faces; it must contain triangles or polygons");
    TRY(spread_texture(builder));
    starg_status status = starg_mesh_adopt(builder->source->context, builder->vertices.data,
                                           builder->vertices.count / 3, builder->faces.data,
                                           builder->faces.count / 3, out);
    if (status == STARG_OK) {
        bool colored = builder->colors.count == builder->vertices.count;
        bool textured = builder->texture.count == 2 * builder->faces.count;
        (*out)->left_out = builder->left_out |
                           (builder->colors.count > 0 && !colored ? STARG_MESH_COLORS : 0) |
                           (builder->texture.count > 0 && !textured ? STARG_MESH_TEXTURE : 0);
        if (textured) {
            (*out)->texture = builder->texture.data;
            builder->texture.data = NULL;
        }
        if (colored) {
            (*out)->colors = builder->colors.data;
            builder->colors.data = NULL;
        }
        builder->vertices.data = NULL;
        builder->faces.data = NULL;
    }
    return status;
}

void starg_builder_free(starg_mesh_builder *builder) {
    RELEASE(builder->vertices.data, builder->faces.data, builder->corners.data,
            builder->colors.data, builder->vertex_texture.data, builder->open_texture.data,
            builder->texture.data);
}
