/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle surface meshes: an immutable indexed face set, with readers and writers. */
#ifndef STARGUARD_MESH_H
#define STARGUARD_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh owns vertex_count x 3 coordinates and face_count x 3 vertex indices. Every coordinate is
 * finite and below 1e100 in magnitude; every index is below vertex_count. Use starg_mesh_check to
 * test whether it bounds a solid. */
typedef struct starg_mesh starg_mesh;

/* Copies the arrays: `vertices` is vertex_count x 3 doubles, `faces` is face_count x 3 indices,
 * counter-clockwise seen from outside. Either count may be 0.
 * Errors: ARGUMENT (an index out of range, more than 2^31 - 1 elements), RANGE, MEMORY. */
STARG_API starg_status starg_mesh_create(starg_context *context, const double *vertices,
                                         size_t vertex_count, const uint32_t *faces,
                                         size_t face_count, starg_mesh **out);
STARG_API void starg_mesh_free(starg_mesh *mesh);

STARG_API size_t starg_mesh_vertex_count(const starg_mesh *mesh);
STARG_API size_t starg_mesh_face_count(const starg_mesh *mesh);
/* vertex_count x 3, owned by the mesh. */
STARG_API const double *starg_mesh_vertices(const starg_mesh *mesh);
/* face_count x 3, owned by the mesh. */
STARG_API const uint32_t *starg_mesh_faces(const starg_mesh *mesh);

/* Red, green and blue of the vertices (sRGB), vertex_count x 3, owned by the mesh; NULL: it has
 * none. A mesh that is read has those of its file (OBJ, OFF, PLY). Setting copies them; NULL
 * removes them. Errors: MEMORY. */
STARG_API const uint8_t *starg_mesh_colors(const starg_mesh *mesh);
STARG_API starg_status starg_mesh_set_colors(starg_mesh *mesh, const uint8_t *colors);

/* Texture coordinates u, v of the corners, v upward, face_count x 3 x 2, owned by the mesh; NULL:
 * it has none. A mesh that is read has those of its file (OBJ, PLY, scenes). Setting copies them;
 * NULL removes them. Errors: MEMORY. */
STARG_API const float *starg_mesh_texture(const starg_mesh *mesh);
STARG_API starg_status starg_mesh_set_texture(starg_mesh *mesh, const float *texture);

/* What the file of the mesh has and the mesh has not: bits of starg_mesh_look. */
typedef enum starg_mesh_look {
    STARG_MESH_COLORS = 1, /* of faces or materials */
    STARG_MESH_TEXTURE = 2 /* texture coordinates, of some corners only */
} starg_mesh_look;
STARG_API unsigned starg_mesh_left_out(const starg_mesh *mesh);

/* Lower and upper corner of the bounding box of all vertices; zeros for an empty mesh. */
STARG_API void starg_mesh_bounds(const starg_mesh *mesh, double lower[3], double upper[3]);
/* Sum of the face areas. */
STARG_API double starg_mesh_area(const starg_mesh *mesh);
/* Signed volume by the divergence theorem: positive when faces point outward. */
STARG_API double starg_mesh_volume(const starg_mesh *mesh);

typedef enum starg_mesh_format {
    STARG_MESH_AUTO = 0, /* reading: by content, then by name; writing: by name */
    STARG_MESH_OFF = 1,
    STARG_MESH_OBJ = 2,
    STARG_MESH_PLY_ASCII = 3,
    STARG_MESH_PLY_BINARY = 4, /* little endian when written; both orders are read */
    STARG_MESH_STL_ASCII = 5,
    STARG_MESH_STL_BINARY = 6,
    STARG_MESH_VTP = 7 /* VTK XML polydata */
} starg_mesh_format;

/* Reads a mesh; path "-" is standard input. The format is recognized by content, else by the file
 * extension. Polygons are triangulated in place (faces keep the file's order): as a fan about the
 * first corner, or by ear clipping if that fan is invalid (at most 4,096 corners). STL corners at
 * exactly equal positions become one vertex. Faces with repeated corners are kept. Normals
 * and materials are ignored, and no other file is opened. A file without faces is an error. Errors:
 * READ, FORMAT (with the line of a text or the byte of a binary file), RANGE (with the vertex),
 * MEMORY, CANCELLED. Messages other than MEMORY and CANCELLED name the file. */
STARG_API starg_status starg_mesh_read(starg_context *context, const char *path, starg_mesh **out);

/* The same from `size` bytes in memory (NULL if 0); `name` is used in messages and as a format
 * hint. */
STARG_API starg_status starg_mesh_read_memory(starg_context *context, const void *bytes,
                                              size_t size, const char *name, starg_mesh **out);

/* A round point near the middle of the bounding box, to be subtracted where coordinates are large
 * for their differences: that loses nothing of doubles. Zero for models about the origin. */
STARG_API void starg_mesh_origin(const starg_mesh *mesh, double origin[3]);

/* Colours for starg_mesh_write: one RGB triple per face, or NULL. Only PLY, OFF and VTP store them,
 * and only VTP stores marks. PLY also stores colours of vertices and texture coordinates. */
typedef struct starg_mesh_write_options {
    starg_mesh_format format;
    const uint8_t *face_colors; /* face_count x 3, or NULL */
    double origin[3];           /* subtracted; PLY, OBJ and STL say so in a comment */
    const int32_t *face_marks;  /* face_count, or NULL */
} starg_mesh_write_options;

STARG_API void starg_mesh_write_options_default(starg_mesh_write_options *options);

/* Writes a mesh; path "-" is standard output and needs a format. The file is written completely or
 * not at all. Reals have 17 significant digits (binary STL: single precision). By name, .ply and
 * .stl are binary. `options` may be NULL. Errors: ARGUMENT (unknown file extension, origin not
 * finite), RANGE (binary STL only: in single precision it would be another surface, with the face
 * or vertex), WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_mesh_write(starg_context *context, const starg_mesh *mesh,
                                        const char *path, const starg_mesh_write_options *options);

#ifdef __cplusplus
}
#endif

#endif
