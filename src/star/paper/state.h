/* SPDX-License-Identifier: Apache-2.0 */
/* What the stages of the paper's decomposition share. */
#ifndef STARG_STAR_PAPER_STATE_H
#define STARG_STAR_PAPER_STATE_H

#include "core/memory.h"
#include "mesh/levels/heap.h"
#include "star/sight.h"

#define PAPER_STAGE "growth"
#define PAPER_NONE  UINT32_MAX

/* Of what growth leaves, small components of no more tetrahedra than PAPER_SMALL_COMPONENT are
 * given to a region whose guard sees PAPER_LEAST_SEEN of their vertices (the paper accepts two to
 * three). */
enum { PAPER_LEAST_SEEN = 2, PAPER_SMALL_COMPONENT = 24 };

/* The tetrahedra around each vertex, ascending: those of v are at[first[v]] to at[first[v + 1]]. */
typedef struct tet_rings {
    size_t *first;
    uint32_t *at;
} tet_rings;

/* A guard and all that growth asks about it. */
typedef struct paper_guard {
    double position[3];
    uint32_t home; /* the first tetrahedron that holds it */
    /* For each vertex that it sees: the first tetrahedron at that vertex into which the segment to
     * the guard runs; PAPER_NONE for the others. */
    uint32_t *toward;
    float *cost; /* f(g, n) of every tetrahedron */
} paper_guard;

/* The solid while it is cut. Piece p grows from guard p. */
typedef struct paper_state {
    starg_context *context;
    starg_tetmesh *mesh;
    double diagonal; /* of its bounding box */
    tet_sight sight;
    tet_rings rings;
    int32_t *labels;            /* below 0: uncoloured */
    STARG_ARRAY(double) guards; /* positions, three a piece */
    mesh_heap *heap;            /* over tetrahedra, empty between calls */
    int32_t *offer;             /* per tetrahedron in the heap: the colour that it is to get */
} paper_state;

/* Errors: MEMORY. */
starg_status tet_rings_create(starg_context *context, const starg_tetmesh *mesh, tet_rings *out);
void tet_rings_free(starg_context *context, tet_rings *rings);

/* The middle of a tetrahedron, rounded. */
static inline void paper_centroid(const paper_state *s, size_t tetrahedron, double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = 0;
        for (int k = 0; k < 4; k++)
            out[i] += 0.25 * tetmesh_corner(s->mesh, tetrahedron, k)[i];
    }
}

static inline size_t paper_pieces(const paper_state *s) {
    return s->guards.count / 3;
}

#endif
