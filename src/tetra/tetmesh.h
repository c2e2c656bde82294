/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of a tetrahedral mesh. */
#pragma once

#include "core/memory.h"
#include "starguard/tetra.h"

struct starg_tetmesh {
    starg_context *context;
    size_t vertex_count, count, turned;
    double *vertices;     /* vertex_count x 3 */
    uint32_t *tetrahedra; /* count x 4 */
    uint32_t *neighbours; /* count x 4 */
    int32_t *regions;     /* count, or NULL */
    double *corners;      /* of a file: count x 4 x 3, in the order of its cells, or NULL */
};

/* Faces (four per tetrahedron) are numbered in 32 bits, with one number reserved for none. */
#define TETMESH_LIMIT ((size_t)1 << 29)

/* Vertices of the face opposite vertex k of a positive tetrahedron, counter-clockwise seen from
 * outside it. */
extern const int TETMESH_FACE[4][3] STARG_PRIVATE(TETMESH_FACE);

static inline const double *tetmesh_corner(const starg_tetmesh *mesh, size_t tetrahedron, int k) {
    return mesh->vertices + 3 * (size_t)mesh->tetrahedra[4 * tetrahedron + (size_t)k];
}

/* Takes ownership of blocks of the context (on success only) after the checks of
 * starg_tetmesh_create; `regions` may be NULL. `trusted`: the caller knows that tetrahedra without
 * a common face do not overlap, which skips the one check that takes more than linear time. */
starg_status tetmesh_adopt(starg_context *context, double *vertices, size_t vertex_count,
                           uint32_t *tetrahedra, size_t count, int32_t *regions, bool trusted,
                           starg_tetmesh **out) STARG_PRIVATE(tetmesh_adopt);

/* Copies vertices, tetrahedra and neighbours, without regions. Errors: MEMORY. */
starg_status tetmesh_copy(starg_context *context, const starg_tetmesh *mesh, starg_tetmesh **out);

/* Exponent of the mesh's extent: differences of coordinates times 2^-exponent are at most 1 in
 * magnitude, so that products of them neither overflow nor underflow as a whole. */
int tetmesh_exponent(const starg_tetmesh *mesh) STARG_PRIVATE(tetmesh_exponent);

/* Six times the volume of a tetrahedron, in units of 2^exponent cubed. */
double tetmesh_scaled_volume(const starg_tetmesh *mesh, size_t tetrahedron, int exponent);

/* Fills the neighbours. Errors: MESH (a face of three tetrahedra, or of two on one side), MEMORY.
 */
starg_status tetmesh_connect(starg_tetmesh *mesh);

/* The least height over the longest edge among all tetrahedra. */
double tetmesh_flattest(const starg_tetmesh *mesh);

/* Errors: MESH (two tetrahedra overlap), MEMORY, CANCELLED. */
starg_status tetmesh_check_overlap(const starg_tetmesh *mesh);

STARG_DROP(starg_tetmesh, starg_tetmesh)
