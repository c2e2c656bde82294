/* SPDX-License-Identifier: Apache-2.0 */
/* Region growing as in the paper: the state, and the steps that change it. */
#pragma once

#include "mesh/levels/heap.h"
#include "star/piece_faces.h"

/* ---- what the stages of the paper's decomposition share (paper.c) ---- */

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
void tet_rings_free(tet_rings *rings);

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

/* ---- what guards see of vertices, and what follows from it for growth (view.c) ---- */

/* A part of the mesh: tetrahedra and their vertices, none twice. */
typedef struct paper_domain {
    uint32_t *tetrahedra, *vertices;
    size_t count, vertex_count;
} paper_domain;

/* Memory for the mesh as a whole, with `waiting` zero. Errors: MEMORY. */
typedef struct view_scratch {
    uint32_t *waiting, *stack;
} view_scratch;
starg_status view_scratch_create(const paper_state *s, view_scratch *out);
void view_scratch_free(view_scratch *scratch);

/* An empty view: nothing is seen. Errors: MEMORY. */
starg_status view_create(const paper_state *s, paper_guard *g);
void view_free(paper_guard *g);

/* Fills `toward` and `cost` within a domain; the position is known. */
void view_fill(const paper_state *s, paper_guard *g, const paper_domain *domain,
               view_scratch *scratch);
/* Takes away what was filled. */
void view_clear(paper_guard *g, const paper_domain *domain);

/* Views of the whole mesh, with homes, for `count` guards strictly inside; `guards` is zero. In
 * parallel. Errors: MEMORY, CANCELLED. */
starg_status views_create(paper_state *s, const paper_domain *all, const double *positions,
                          size_t count, paper_guard *guards);

/* ---- what hangs together by faces and has no colour yet (uncoloured.c) ---- */

typedef struct component_search {
    paper_domain found;
    uint32_t *number;                 /* of a found vertex in `found` */
    uint32_t *tet_mark, *vertex_mark; /* the search in which it was found last */
    uint32_t search;
} component_search;

/* Memory for all searches; free it also after a failure. Errors: MEMORY. */
starg_status component_create(const paper_state *s, component_search *out);
void component_free(component_search *c);

/* Finds the uncoloured component of a tetrahedron, breadth first. */
void component_find(const paper_state *s, component_search *c, uint32_t tetrahedron);

/* ---- on which tetrahedra does the visibility of a tetrahedron depend? (dependency.c) ---- */

/* The first tetrahedron, in the order of the mesh, whose closed hull holds p; PAPER_NONE outside.
 */
uint32_t dependency_home(const starg_tetmesh *mesh, const double p[3]);

/* The first tetrahedron around `vertex` into which the segment from there to p runs. */
uint32_t dependency_toward(const paper_state *s, uint32_t vertex, const double p[3]);

/* The tetrahedron that vertex k of a tetrahedron asks for when the latter is coloured, or
 * PAPER_NONE where it asks for none. The guard sees the vertex. */
uint32_t dependency_predecessor(const paper_state *s, const paper_guard *g, uint32_t tetrahedron,
                                int k);

/* Vertices of a tetrahedron that the guard sees, 0 to 4. */
int dependency_seen(const paper_state *s, const paper_guard *g, uint32_t tetrahedron);

/* ---- how many tetrahedra depend on each (cost.c) ---- */

/* Fills the costs of the `count` tetrahedra of `domain` (none twice) from the guard's `toward`.
 * `waiting` and `stack` have room for every tetrahedron of the mesh; `waiting` is zero in the
 * domain and left so. */
void cost_accumulate(const paper_state *s, paper_guard *g, const uint32_t *domain, size_t count,
                     uint32_t *waiting, uint32_t *stack);

/* ---- region growing by node merging (growth.c) ---- */

/* Guards whose pieces grow: guard i gives colour first_colour + i. */
typedef struct paper_front {
    const paper_guard *guards;
    size_t count;
    int32_t first_colour;
} paper_front;

/* Colours the homes of the guards, as far as they are uncoloured, and from there every uncoloured
 * tetrahedron whose predecessors have its colour, biggest cost first. */
void growth_strict(paper_state *s, const paper_front *front);

/* Colours uncoloured tetrahedra of `domain` that share a face with a region of the front and have
 * at least `least` vertices that its guard sees; most vertices first, then the nearest to the
 * guard. */
void growth_relaxed(paper_state *s, const paper_front *front, const uint32_t *domain, size_t count,
                    int least);

/* Colours uncoloured tetrahedra of `domain` like a region that they touch, whatever its guard sees;
 * those that hang together with no region stay as they are. */
void growth_absorb(paper_state *s, const uint32_t *domain, size_t count);

/* ---- what no guard's region holds (uncoloured.c) ---- */

/* Guards each uncoloured component anew and grows again, until every tetrahedron has a colour.
 * There are no more than `max_pieces` pieces (0: any number) unless parts of the mesh have no guard
 * yet, and no more of them once time is over, which *time_limited then tells. Errors: MEMORY,
 * CANCELLED. */
starg_status uncoloured_regrow(paper_state *s, size_t max_pieces, bool *time_limited);

/* ---- smoothing of the borders between pieces (smooth.c) ---- */

/* Moves inner vertices where pieces meet; every tetrahedron stays positive. Errors: MEMORY,
 * CANCELLED. */
starg_status smooth_borders(paper_state *s);
