/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the mesh readers and writers: sources with places for messages, the builder that
 * readers fill, and the functions of each format. */
#pragma once

#include "core/file.h"
#include "mesh/mesh.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define STARG_MESH_FILE "mesh file" /* stage in messages */

/* ---- files in memory, and places in them for messages (read.c, builder.c) ---- */

/* A file in memory. */
typedef struct starg_source {
    starg_context *context;
    const char *name; /* for messages */
    const char *bytes;
    size_t size;
} starg_source;

/* Shortens a long name to its end, to leave room for the message; `size` bytes for `shown`. */
void starg_source_shorten(const char *name, char *shown, size_t size);

/* A position in a source: a line (from 1), a byte (from 0), or the whole file. */
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

/* Records a FORMAT error whose message starts with the name and the place. */
starg_status starg_source_fail(const starg_source *source, starg_place place, const char *format,
                               ...) __attribute__((format(printf, 3, 4)));

/* ---- values of faces by a name in their file: groups, materials (face_lists.c) ---- */

/* Values of faces by a name in their file: groups, materials, properties. */
typedef struct starg_face_values {
    const char *pattern;      /* wanted; * stands for any characters, ? for one */
    const char *equals;       /* in it, where "=value" begins, or NULL */
    double wanted;            /* that value; NAN: no number */
    bool compared;            /* a property is wanted where it has that value */
    bool found;               /* a name in the file is wanted */
    double current;           /* of the next face */
    STARG_ARRAY(double) data; /* by triangle so far */
    char others[160];         /* names in the file, for messages */
    /* If groups are collected in place of one name, `current` is the number of the group of the
     * next face, from 1 on; 0: none. */
    bool collects;
    size_t group_count;
    STARG_ARRAY(char) names; /* of the groups, each ended by a zero byte */
} starg_face_values;

/* Is the name of a group, or of a property, wanted? */
bool starg_values_want(starg_face_values *values, const char *name, size_t length);
bool starg_values_want_property(starg_face_values *values, const char *name, size_t length);

/* Notes a name of the file for messages. */
void starg_values_note(starg_face_values *values, const char *name, size_t length);

/* The number of a group that is collected, from 1 on. Errors: MEMORY. */
starg_status starg_values_collect(starg_context *context, starg_face_values *values,
                                  const char *name, size_t length, double *number);

/* Takes the value of a wanted property for the next face; before the first one, `current` is 0. */
void starg_values_take(starg_face_values *values, double value);

/* ---- a mesh under construction, checked on arrival (builder.c) ---- */

/* A mesh under construction. Every vertex and corner is checked on arrival, so that errors name
 * their place. Zero-initialize all but `source`. */
typedef struct starg_mesh_builder {
    const starg_source *source;
    char **owned; /* the block that begins with the source's bytes, which its reader may shrink, or
                     NULL */
    STARG_ARRAY(double) vertices;  /* 3 numbers per vertex */
    STARG_ARRAY(uint32_t) faces;   /* 3 indices per triangle */
    STARG_ARRAY(uint32_t) corners; /* of the open face */
    STARG_ARRAY(uint8_t) colors;   /* 3 numbers per vertex, or those of fewer: then none count */
    /* Texture coordinates, 2 numbers each: of vertices, of the open face's corners, and of the
     * corners of all triangles; those of fewer do not count. */
    STARG_ARRAY(float) vertex_texture, open_texture, texture;
    starg_face_values *values; /* NULL: not wanted */
    unsigned left_out;         /* starg_mesh_look: what the reader passes over */
    size_t ticks;
} starg_mesh_builder;

/* Reserves space; the caller has checked the numbers against the size of the source. */
starg_status starg_builder_reserve(starg_mesh_builder *builder, size_t vertices, size_t faces);

/* Appends a vertex. Errors: RANGE, MEMORY. */
starg_status starg_builder_vertex(starg_mesh_builder *builder, const double point[3],
                                  starg_place place);

/* Gives the last vertex a colour, of numbers from 0 to `most`. Errors: MEMORY. */
starg_status starg_builder_color(starg_mesh_builder *builder, const double color[3], double most);

/* Appends a corner to the open face. Errors: FORMAT (no such vertex), MEMORY. */
starg_status starg_builder_corner(starg_mesh_builder *builder, int64_t vertex, starg_place place);

/* Appends a texture coordinate of a vertex, or of a corner of the open face. Errors: MEMORY. */
starg_status starg_builder_vertex_texture(starg_mesh_builder *builder, const double uv[2]);
starg_status starg_builder_corner_texture(starg_mesh_builder *builder, const double uv[2]);

/* Empties the builder, for another attempt. */
void starg_builder_restart(starg_mesh_builder *builder);

/* Closes the open face and triangulates it. Errors: FORMAT (fewer than 3 corners), MEMORY. */
starg_status starg_builder_face(starg_mesh_builder *builder, starg_place place);

/* Called once per item with the number of bytes read: progress and cancellation. */
starg_status starg_builder_tick(starg_mesh_builder *builder, size_t done);

/* Returns the mesh. Errors: FORMAT (no faces), MEMORY. */
starg_status starg_builder_finish(starg_mesh_builder *builder, starg_mesh **out);
void starg_builder_free(starg_mesh_builder *builder);

static inline size_t starg_builder_vertex_count(const starg_mesh_builder *builder) {
    return builder->vertices.count / 3;
}

/* ---- polygons as triangles (polygon.c) ---- */

/* Both write count - 2 triangles with the polygon's orientation.
 * fan uses the fan about the first corner and returns false if that is invalid; clip clips ears in
 * quadratic time. */
bool starg_polygon_fan(const double *vertices, const uint32_t *corners, size_t count,
                       uint32_t *triangles);
starg_status starg_polygon_clip(starg_context *context, const double *vertices,
                                const uint32_t *corners, size_t count, uint32_t *triangles);

/* ---- files that another program has to read (import.c) ---- */

/* Is it a scene that another program has to read? */
bool starg_import_recognized(const char *bytes, size_t size, const char *name);
/* Reads a file for starg_mesh_read_with; of a scene that is a PLY. *up: which axis the scene's
 * format says is up, in words, or NULL. */
starg_status starg_mesh_bytes(starg_context *context, const char *path, char **bytes, size_t *size,
                              const char **up);

/* ---- readers (read.c and a file for each format) ---- */

/* starg_mesh_read_memory that also finds values of faces; NULL: none are wanted. */
starg_status starg_mesh_read_with(starg_context *context, const void *bytes, size_t size,
                                  const char *name, starg_face_values *values, starg_mesh **out);

/* Readers. `matches` recognizes the format by content; `read` fills the builder and never reads
 * beyond the source. */
bool starg_off_matches(const starg_source *source);
bool starg_obj_matches(const starg_source *source);
bool starg_ply_matches(const starg_source *source);
bool starg_stl_matches(const starg_source *source);
bool starg_vtk_matches(const starg_source *source);
bool starg_vtp_matches(const starg_source *source);
starg_status starg_off_read(starg_mesh_builder *builder);
starg_status starg_obj_read(starg_mesh_builder *builder);
starg_status starg_ply_read(starg_mesh_builder *builder);
starg_status starg_stl_read(starg_mesh_builder *builder);
starg_status starg_vtk_read(starg_mesh_builder *builder);
starg_status starg_vtp_read(starg_mesh_builder *builder);

/* ---- writers (write.c and a file for each format) ---- */

/* What a file holds beside the mesh, as far as its format can. */
typedef struct starg_mesh_extras {
    const uint8_t *colors; /* face_count x 3, or NULL */
    const int32_t *marks;  /* face_count, or NULL */
    char note[96];         /* a comment, or empty */
} starg_mesh_extras;

/* Writers. The caller checks for stream errors. */
typedef void starg_mesh_writer(FILE *stream, const starg_mesh *mesh,
                               const starg_mesh_extras *extras);
starg_mesh_writer starg_ply_write_ascii, starg_ply_write_binary, starg_stl_write_ascii,
    starg_stl_write_binary, starg_vtp_write;

/* True if `name` ends with `extension`, ignoring case. */
bool starg_has_extension(const char *name, const char *extension);

/* ---- welding: merges points at exactly equal positions (weld.c) ---- */

typedef struct starg_weld {
    starg_mesh_builder *builder;
    uint32_t *slots; /* vertex + 1, or 0 for a free slot; open addressing, at most half full */
    size_t size;     /* a power of two */
} starg_weld;

/* The builder's vertex at `point`, appended if it is new; vertices are in order of first
 * appearance, and -0 equals 0. Errors: RANGE, MEMORY. */
starg_status starg_weld_point(starg_weld *weld, const double point[3], starg_place place,
                              uint32_t *vertex);
void starg_weld_free(starg_weld *weld);

/* ---- numbers as little-endian bytes ---- */

static inline void pack_u32(unsigned char *bytes, uint32_t value) {
    for (int i = 0; i < 4; i++)
        bytes[i] = (unsigned char)(value >> 8 * i);
}

static inline void pack_f32(unsigned char *bytes, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    pack_u32(bytes, bits);
}

static inline void pack_f64(unsigned char *bytes, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    pack_u32(bytes, (uint32_t)bits);
    pack_u32(bytes + 4, (uint32_t)(bits >> 32));
}
