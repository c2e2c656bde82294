/* Tetrahedra that go with a morph. */
#ifndef STARG_MORPH_CARRY_H
#define STARG_MORPH_CARRY_H

#include "core/context.h"
#include "core/memory.h"
#include "starguard/morph.h"

/* Tetrahedra of A, where they are at the moment, and which vertices the surface holds. */
typedef struct carried {
    starg_context *context;
    size_t fixed;                     /* vertices of the surface: the first ones */
    const uint32_t *surface;          /* their numbers in the morph's mesh; borrowed */
    STARG_ARRAY(double) rest;         /* x 3: places in A */
    STARG_ARRAY(double) now;          /* x 3: places at the moment */
    STARG_ARRAY(uint32_t) tetrahedra; /* x 4 */
} carried;

/* An edge by both vertices, the lower one in the upper half. */
typedef uint64_t carried_edge;

static inline carried_edge carried_edge_of(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* The corners of the six edges of a tetrahedron. */
extern const int CARRIED_EDGES[6][2];

/* Is it in the ascending list? */
bool carried_edge_in(const carried_edge *list, size_t count, carried_edge edge);
/* Makes a list ascending and free of doubles. */
void carried_edges_sort(carried_edge *list, size_t *count);

/* Puts a vertex in the middle of every edge of the ascending list, which splits the tetrahedra
 * about it; not where a part would have no volume in A (split.c). Errors: MEMORY. */
starg_status carried_split(carried *c, const carried_edge *edges, size_t count);

/* Takes the inner vertices of `c`, which is as A is, along while the morph goes to B. *inverted is
 * 0, or so many tetrahedra could not be kept positive near `*reached`. Errors: SOLVER, MEMORY,
 * CANCELLED. */
starg_status carry(const starg_morph *m, carried *c, size_t *inverted, double *reached);

static inline void carried_free(carried *c) {
    STARG_ARRAY_FREE(c->context, &c->rest);
    STARG_ARRAY_FREE(c->context, &c->now);
    STARG_ARRAY_FREE(c->context, &c->tetrahedra);
}

#endif
