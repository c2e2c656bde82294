/* SPDX-License-Identifier: Apache-2.0 */
/* Compatible decomposition: pieces that are star-shaped in two solids at once. */
#pragma once

#include "core/context.h"
#include "starguard/decompose.h"

/* Labels the tetrahedra of a mesh so that every piece is strictly star-shaped in it and in its
 * image, the same tetrahedra in other places. out[0] is the mesh in pieces, out[1] the image in the
 * same pieces; copies of both. With `cut` tetrahedra may be divided, alike in both and positive,
 * which saves pieces; the given vertices come first. Errors: MESH (a tetrahedron so thin that no
 * point is found in it), MEMORY, CANCELLED. */
starg_status compatible_decompose(starg_context *context, const starg_tetmesh *mesh,
                                  const starg_tetmesh *image, bool cut, starg_decomposition *out[2])
    STARG_PRIVATE(compatible_decompose);

/* The same from pieces that are star-shaped in both, by label and with their guards (count x 3) in
 * either: neighbours are joined where the union is star-shaped. Errors: MEMORY, CANCELLED. */
starg_status compatible_join(starg_context *context, const starg_tetmesh *mesh,
                             const starg_tetmesh *image, const uint32_t *labels,
                             const double *const guards[2], size_t count,
                             starg_decomposition *out[2]) STARG_PRIVATE(compatible_join);

/* Tetrahedra that fill two solids alike. */
typedef struct compatible_cones {
    size_t vertex_count, surface_count; /* those of the surface come first */
    double *places[2];                  /* vertex_count x 3 */
    size_t count;
    uint32_t *tetrahedra; /* count x 4: the last corner is a point that sees the piece */
    size_t piece_count;
    uint32_t *labels; /* count */
} compatible_cones;

/* Triangles in two places. */
typedef struct compatible_surface {
    const double *places[2]; /* vertex_count x 3 */
    size_t vertex_count, count;
    const uint32_t *faces; /* count x 3 */
    const uint32_t *sides; /* count x 2: the pieces before and behind a triangle, each bounded by a
                              sphere, or UINT32_MAX; NULL: all faces bound one piece, outward */
    size_t piece_count;    /* 1 without sides */
    size_t work;           /* as many faces may be looked at for cuts; 0: by their number */
} compatible_surface;

/* Fills two solids, bounded by the same faces in two places, with the same tetrahedra, positive in
 * both: cones in pieces that are star-shaped in both (cones.c). The surface is divided in its
 * faces. *left: pieces that could not be cut further; then there is no result. Errors: MEMORY,
 * CANCELLED.
 */
starg_status compatible_fill(starg_context *context, const compatible_surface *surface,
                             compatible_cones *out, size_t *left) STARG_PRIVATE(compatible_fill);
void compatible_cones_free(starg_context *context, compatible_cones *cones)
    STARG_PRIVATE(compatible_cones_free);
