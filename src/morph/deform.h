/* SPDX-License-Identifier: Apache-2.0 */
/* Mesh deformation: tetrahedra that go with a morph. */
#ifndef STARG_MORPH_DEFORM_H
#define STARG_MORPH_DEFORM_H

#include "core/context.h"
#include "core/memory.h"
#include "starguard/morph.h"

/* Tetrahedra of A, where they are at the moment, and which vertices the surface holds. */
typedef struct deform_mesh {
    starg_context *context;
    size_t fixed;                     /* vertices of the surface: the first ones */
    const uint32_t *surface;          /* their numbers in the morph's mesh; borrowed */
    STARG_ARRAY(double) rest;         /* x 3: places in A */
    STARG_ARRAY(double) now;          /* x 3: places at the moment */
    STARG_ARRAY(uint32_t) tetrahedra; /* x 4 */
} deform_mesh;

/* An edge by both vertices, the lower one in the upper half. */
typedef uint64_t deform_edge;

static inline deform_edge deform_edge_of(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* The corners of the six edges of a tetrahedron. */
extern const int DEFORM_EDGES[6][2];

/* Is it in the ascending list? */
bool deform_edge_in(const deform_edge *list, size_t count, deform_edge edge);
/* Makes a list ascending and free of doubles. */
void deform_edges_sort(deform_edge *list, size_t *count);

/* Puts a vertex in the middle of every edge of the ascending list, which splits the tetrahedra
 * about it; not where a part would have no volume in A (split.c). Errors: MEMORY. */
starg_status deform_split(deform_mesh *c, const deform_edge *edges, size_t count);

/* Takes the inner vertices of `c`, which is as A is, along while the morph goes to B. *inverted is
 * 0, or so many tetrahedra could not be kept positive near `*reached`. Errors: SOLVER, MEMORY,
 * CANCELLED. */
starg_status deform(const starg_morph *m, deform_mesh *c, size_t *inverted, double *reached);

static inline void deform_free(deform_mesh *c) {
    STARG_ARRAY_FREE(c->context, &c->rest);
    STARG_ARRAY_FREE(c->context, &c->now);
    STARG_ARRAY_FREE(c->context, &c->tetrahedra);
}

#endif
