/* SPDX-License-Identifier: Apache-2.0 */
/* What the mesh readers and writers share: bytes with their place in messages, the builder that
 * readers feed, and the functions of each format. */
#ifndef STARG_MESH_FORMATS_IO_H
#define STARG_MESH_FORMATS_IO_H

#include <locale.h>
#include <stdbool.h>
#include <stdio.h>

#include "core/context.h"
#include "core/memory.h"
#include "core/private.h"
#include "mesh/mesh.h"

#define STARG_MESH_FILE "mesh file" /* stage in messages */

/* A file in memory, as a reader sees it. */
typedef struct starg_source {
    starg_context *context;
    const char *name; /* as messages show it */
    const char *bytes;
    size_t size;
} starg_source;

/* A place in a source: a line from 1 on, a byte from 0 on, or the file as a whole. */
typedef struct starg_place {
    starg_element element; /* STARG_ELEMENT_LINE, _BYTE or _NONE */
    size_t at;
} starg_place;

static inline starg_place starg_at_line(size_t line) {
    return (starg_place){STARG_ELEMENT_LINE, line};
}

static inline starg_place starg_at_byte(size_t byte) {
    return (starg_place){STARG_ELEMENT_BYTE, byte};
}

static inline starg_place starg_at_file(void) {
    return (starg_place){STARG_ELEMENT_NONE, 0};
}

/* Records a FORMAT error whose message begins with the name and the place. */
starg_status starg_source_fail(const starg_source *source, starg_place place, const char *format,
                               ...) __attribute__((format(printf, 3, 4)));

/* A mesh under construction. Every vertex and corner is checked when it comes, so that errors
 * name their place. All zero but `source` to begin with. */
typedef struct starg_mesh_builder {
    const starg_source *source;
    STARG_ARRAY(double) vertices;  /* 3 numbers per vertex         */
    STARG_ARRAY(uint32_t) faces;   /* 3 indices per triangle       */
    STARG_ARRAY(uint32_t) corners; /* of the face that is not closed yet */
    size_t ticks;
} starg_mesh_builder;

/* Room for so many, which the caller has checked against the size of the source. */
starg_status starg_builder_reserve(starg_mesh_builder *builder, size_t vertices, size_t faces);

/* Appends a vertex. Errors: RANGE, MEMORY. */
starg_status starg_builder_vertex(starg_mesh_builder *builder, const double point[3],
                                  starg_place place);

/* Appends a corner to the open face. Errors: FORMAT (no such vertex), MEMORY. */
starg_status starg_builder_corner(starg_mesh_builder *builder, int64_t vertex, starg_place place);

/* Ends the open face and cuts it into triangles. Errors: FORMAT (fewer than 3 corners), MEMORY. */
starg_status starg_builder_face(starg_mesh_builder *builder, starg_place place);

/* Called once per item with the number of bytes that are done: progress and cancellation. */
starg_status starg_builder_tick(starg_mesh_builder *builder, size_t done);

/* Hands the mesh over. Errors: FORMAT (no faces), MEMORY. */
starg_status starg_builder_finish(starg_mesh_builder *builder, starg_mesh **out);
void starg_builder_free(starg_mesh_builder *builder);

static inline size_t starg_builder_vertex_count(const starg_mesh_builder *builder) {
    return builder->vertices.count / 3;
}

/* Polygons (polygon.c). Both write count - 2 triangles that keep the polygon's orientation.
 * fan tries the fan about the first corner and is false when that does not do; clip cuts off ears
 * in quadratic time. */
bool starg_polygon_fan(const double *vertices, const uint32_t *corners, size_t count,
                       uint32_t *triangles);
starg_status starg_polygon_clip(starg_context *context, const double *vertices,
                                const uint32_t *corners, size_t count, uint32_t *triangles);

/* Readers. `matches` tells by the content alone whether this is the format; `read` feeds the
 * builder and never reads outside the source. */
bool starg_off_matches(const starg_source *source);
bool starg_obj_matches(const starg_source *source);
bool starg_ply_matches(const starg_source *source);
bool starg_stl_matches(const starg_source *source);
starg_status starg_off_read(starg_mesh_builder *builder);
starg_status starg_obj_read(starg_mesh_builder *builder);
starg_status starg_ply_read(starg_mesh_builder *builder);
starg_status starg_stl_read(starg_mesh_builder *builder);

/* Writers. Errors of the stream are left to the caller; `colors` is NULL or face_count x 3. */
void starg_off_write(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);
void starg_obj_write(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);
void starg_ply_write_ascii(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);
void starg_ply_write_binary(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);
void starg_stl_write_ascii(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);
void starg_stl_write_binary(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);

/* The vertices and the faces of a mesh as lines of text, which OFF and PLY have in common. */
void starg_write_lines(FILE *stream, const starg_mesh *mesh, const uint8_t *colors);

/* True when `name` ends with `extension`, in any case. */
bool starg_has_extension(const char *name, const char *extension);

/* Numbers are read and written with a point whatever locale the program has chosen: the calling
 * thread works in the "C" locale between enter and leave. Errors: MEMORY. */
typedef struct starg_c_locale {
    locale_t own, before;
} starg_c_locale;

starg_status starg_c_locale_enter(starg_context *context, starg_c_locale *locale)
    STARG_PRIVATE(starg_c_locale_enter);
/* Harmless for an all-zero `locale`. */
void starg_c_locale_leave(starg_c_locale *locale) STARG_PRIVATE(starg_c_locale_leave);

#endif
