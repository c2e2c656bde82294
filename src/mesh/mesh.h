/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of a mesh. */
#pragma once

#include "core/memory.h"
#include "starguard/mesh.h"

struct starg_mesh {
    starg_context *context;
    size_t vertex_count, face_count;
    double *vertices;  /* vertex_count x 3 */
    uint32_t *faces;   /* face_count x 3 */
    uint8_t *colors;   /* vertex_count x 3, sRGB; NULL: none */
    float *texture;    /* face_count x 3 x 2; NULL: none */
    unsigned left_out; /* starg_mesh_look: in its file only */
};

/* Largest number of vertices or faces. */
#define STARG_MESH_LIMIT ((size_t)0x7fffffff)

/* Upper bound on the magnitude of coordinates. */
#define STARG_COORDINATE_LIMIT 1e100

/* Least extent of a solid: squares of areas underflow far below this. */
#define STARG_EXTENT_LEAST 1e-90

/* Is its extent 0, or at least STARG_EXTENT_LEAST? */
bool mesh_is_wide(const starg_mesh *mesh);

/* Errors: RANGE, if the mesh has an extent below STARG_EXTENT_LEAST other than 0. */
starg_status mesh_check_extent(starg_context *context, const starg_mesh *mesh, const char *stage);

/* Diagonal of the bounding box. */
double mesh_diagonal(const starg_mesh *mesh) STARG_PRIVATE(mesh_diagonal);

/* Length of the shortest edge that has one; INFINITY if there is none. */
double mesh_shortest_edge(const starg_mesh *mesh);

/* Exponent of the mesh's extent: differences of coordinates times 2^-exponent are at most 1 in
 * magnitude, so that products of them neither overflow nor underflow as a whole. */
int starg_mesh_exponent(const starg_mesh *mesh);

/* Corner k of a face, relative to the first vertex and scaled by 2^-exponent. */
void starg_mesh_scaled_corner(const starg_mesh *mesh, size_t face, size_t k, int exponent,
                              double out[3]);

/* Takes ownership of two blocks of the context (on success only), after the checks of
 * starg_mesh_create. */
starg_status starg_mesh_adopt(starg_context *context, double *vertices, size_t vertex_count,
                              uint32_t *faces, size_t face_count, starg_mesh **out);

STARG_DROP(starg_mesh, starg_mesh)

/* ---- what single precision, or another rounding, does to a surface (single.c) ---- */
/* Every writer of it asks. */

/* Where a surface goes, for messages. */
typedef struct single_place {
    const char *stage;
    const char *file;   /* NULL: not known */
    const char *what;   /* "the model", "frame 3" */
    const char *how;    /* NULL: "in single precision" */
    const char *remedy; /* what keeps it: "write OFF, OBJ or PLY" */
} single_place;

/* Are the faces still those of the same surface with vertices at `rounded`, which is only read?
 * Errors: RANGE, with the element and the reason; MEMORY, CANCELLED. */
starg_status single_compare(starg_context *context, const starg_mesh *surface, double *rounded,
                            const single_place *place);

/* The same for vertices less `origin` (NULL: zero) as single precision holds them. */
starg_status single_check(starg_context *context, const starg_mesh *surface, const double origin[3],
                          const single_place *place);
