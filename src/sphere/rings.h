/* SPDX-License-Identifier: Apache-2.0 */
/* A closed triangulated sphere that loses and regains its vertices one by one. */
#ifndef STARG_SPHERE_RINGS_H
#define STARG_SPHERE_RINGS_H

#include <stdbool.h>

#include "core/memory.h"
#include "mesh/mesh.h"

/* The neighbours of a vertex, counter-clockwise seen from outside. */
typedef STARG_ARRAY(uint32_t) ring;

/* A vertex that was merged into `ring[0]`, and its neighbours at that time. */
typedef struct ring_removal {
    uint32_t vertex, count;
    size_t ring; /* first of its neighbours in rings->removed */
} ring_removal;

typedef struct rings {
    starg_context *context;
    const double *positions; /* of the mesh, borrowed */
    size_t vertex_count, left;
    ring *of;       /* per vertex; empty while it is out */
    uint32_t *mark; /* per vertex; all zero between calls */
    ring removed;
    STARG_ARRAY(ring_removal) removals;
} rings;

/* Of a closed, oriented 2-manifold of genus 0 in one part that uses all its vertices, which the
 * caller has made sure of. The mesh is borrowed. Errors: MEMORY. */
starg_status rings_create(starg_context *context, const starg_mesh *mesh, rings **out);
void rings_free(rings *r);

/* What reducing must leave; without any of these (NULL) it ends with a tetrahedron. */
typedef struct rings_limits {
    size_t least;             /* as many vertices stay, at least 4                          */
    const uint8_t *kept;      /* per vertex: stays; or NULL                                 */
    const double *directions; /* an embedding in the sphere that must stay valid; or NULL   */
} rings_limits;

/* Takes vertices out, short edges first, as far as the limits allow. Errors: MEMORY, CANCELLED. */
starg_status rings_reduce(rings *r, const rings_limits *limits) STARG_PRIVATE(rings_reduce);

/* Puts the last removed vertex back. Errors: MEMORY. */
starg_status rings_restore(rings *r);

#endif
