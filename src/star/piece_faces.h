/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra with labels: their neighbours and faces, lines of sight through them, their angles. */
#pragma once

#include "starguard/decompose.h"
#include "tetra/tetmesh.h"
#include "visibility/kernel.h"

/* ---- the boundary faces of labelled sets of tetrahedra (piece_faces.c) ---- */

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
void piece_faces_free(piece_faces *faces);

static inline kernel_faces piece_faces_of(const piece_faces *faces, size_t p) {
    return (kernel_faces){faces->vertices, faces->corners + 3 * faces->first[p],
                          faces->first[p + 1] - faces->first[p]};
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
                             const uint32_t *labels, size_t face, uint32_t own, uint32_t other,
                             face_corners *out);

/* ---- sight inside of a tetrahedral mesh: its boundary alone blocks it (piece_faces.c) ---- */

typedef struct tet_sight {
    uint32_t *faces; /* of the boundary, outward */
    bvh *tree;       /* of them */
} tet_sight;

/* The mesh must outlive it; vertices inside may move. Errors: MEMORY. */
starg_status tet_sight_create(starg_context *context, const starg_tetmesh *mesh, tet_sight *out)
    STARG_PRIVATE(tet_sight_create);
void tet_sight_free(tet_sight *sight) STARG_PRIVATE(tet_sight_free);

/* Is p strictly inside of the mesh? Exact. */
bool tet_sight_contains(const tet_sight *sight, const double p[3]);

/* Does the boundary leave the segment [p, q) free? Then p, strictly inside, sees q. Exact. */
bool tet_sight_is_free(const tet_sight *sight, const double p[3], const double q[3]);

/* ---- how good the tetrahedra of a decomposition are (angles.c) ---- */

/* The smallest dihedral angle of a tetrahedron, in degrees. The first corner is the origin. */
double angles_smallest(const double corners[4][3]);

/* Sets smallest_angle and median_angle. Errors: MEMORY. */
starg_status angles_measure(starg_context *context, starg_decomposition *d);

/* Sets smallest_angle_made, for the model whose surface was kept. Errors: MEMORY. */
starg_status angles_tell_apart(starg_context *context, const starg_mesh *model,
                               starg_decomposition *d);
