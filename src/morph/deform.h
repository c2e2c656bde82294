/* SPDX-License-Identifier: Apache-2.0 */
/* Mesh deformation: tetrahedra that follow a morph. */
#pragma once

#include "core/memory.h"
#include "starguard/morph.h"

/* Tetrahedra of A at their current places, and which vertices are on the surface. */
typedef struct deform_mesh {
    starg_context *context;
    size_t fixed;                     /* vertices of the surface, which come first */
    const uint32_t *surface;          /* their numbers in the morph's mesh; borrowed */
    STARG_ARRAY(double) rest;         /* x 3: positions in A */
    STARG_ARRAY(double) now;          /* x 3: current positions */
    STARG_ARRAY(uint32_t) tetrahedra; /* x 4 */
} deform_mesh;

/* An edge: both vertices, the lower one in the upper half. */
typedef uint64_t deform_edge;

static inline deform_edge deform_edge_of(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* The corners of the six edges of a tetrahedron. */
extern const int DEFORM_EDGES[6][2];

/* Is the edge in the ascending list? */
bool deform_edge_in(const deform_edge *list, size_t count, deform_edge edge);
/* Sorts a list and removes duplicates. */
void deform_edges_sort(deform_edge *list, size_t *count);

/* Inserts a vertex into the middle of every edge of the ascending list, which splits its
 * tetrahedra; skips edges where a part would have no volume in A (split.c). Errors: MEMORY. */
starg_status deform_split(deform_mesh *c, const deform_edge *edges, size_t count);

/* Inserts a vertex into the middle of every tetrahedron with all corners on the surface, unless a
 * part would have no volume in A (split.c). Errors: MEMORY. */
starg_status deform_fill_flat(deform_mesh *c);

/* Splits what leaves no freedom where the surface bends: edges and tetrahedra inside whose corners
 * are all on it. Errors: MEMORY. */
starg_status deform_free_surface(const starg_morph *m, deform_mesh *c);

/* Moves the surface to B and each inner vertex as far as its neighbours on average. Tetrahedra may
 * be inverted. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status deform_harmonic(const starg_morph *m, deform_mesh *c);

/* Where the vertices pass: straight from one row of places to the next. */
typedef struct deform_path {
    STARG_ARRAY(double) times;  /* ascending, above 0 */
    STARG_ARRAY(double) places; /* x 3 per vertex, a row for each time */
} deform_path;

/* Moves the inner vertices of `c`, initially as in A, along with the morph to B. *inverted is 0, or
 * the number of tetrahedra that could not be kept positive near `*reached`. With a path (or NULL),
 * initially empty, steps are shorter, and every tetrahedron is proven to be positive at every
 * moment of each. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status deform(const starg_morph *m, deform_mesh *c, deform_path *path, size_t *inverted,
                    double *reached);

static inline void deform_free(deform_mesh *c) {
    RELEASE(c->rest.data, c->now.data, c->tetrahedra.data);
}
