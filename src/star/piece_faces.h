/* SPDX-License-Identifier: Apache-2.0 */
/* The boundary faces of labelled sets of tetrahedra. */
#ifndef STARG_STAR_PIECE_FACES_H
#define STARG_STAR_PIECE_FACES_H

#include "core/memory.h"
#include "tetra/tetmesh.h"
#include "visibility/kernel.h"

/* Faces first[p] to first[p + 1] - 1 bound piece p, counter-clockwise seen from outside of it. */
typedef struct piece_faces {
    const double *vertices; /* of the mesh, borrowed */
    size_t piece_count;
    size_t *first;     /* piece_count + 1 */
    uint32_t *corners; /* three a face */
} piece_faces;

/* In the order of tetrahedra and their faces within a piece. Errors: MEMORY. */
starg_status piece_faces_create(starg_context *context, const starg_tetmesh *mesh,
                                const int32_t *labels, size_t piece_count, piece_faces *out);
void piece_faces_free(starg_context *context, piece_faces *faces);

static inline kernel_faces piece_faces_of(const piece_faces *faces, size_t piece) {
    return (kernel_faces){faces->vertices, faces->corners + 3 * faces->first[piece],
                          faces->first[piece + 1] - faces->first[piece]};
}

/* The vertices of face `face` (4 x tetrahedron + vertex opposite), outward. */
static inline void piece_face_corners(const starg_tetmesh *mesh, size_t face, uint32_t out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = mesh->tetrahedra[(face & ~(size_t)3) + (size_t)TETMESH_FACE[face & 3][k]];
}

typedef STARG_ARRAY(uint32_t) face_corners; /* three a face */

/* Appends a face, unless the tetrahedron across it is in one of two pieces (or one, given twice).
 * Errors: MEMORY. */
starg_status piece_faces_add(starg_context *context, const starg_tetmesh *mesh,
                             const uint32_t *labels, size_t face, uint32_t piece, uint32_t other,
                             face_corners *out);

#endif
