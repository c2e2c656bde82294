/* SPDX-License-Identifier: Apache-2.0 */
/* A closed triangulated sphere with removable vertices. */
#ifndef STARG_SPHERE_RINGS_H
#define STARG_SPHERE_RINGS_H

#include <stdbool.h>

#include "core/memory.h"
#include "mesh/mesh.h"

/* The neighbours of a vertex, counter-clockwise seen from outside. */
typedef STARG_ARRAY(uint32_t) ring;

/* A vertex merged into `ring[0]`, and its neighbours at that time. */
typedef struct ring_removal {
    uint32_t vertex, count;
    size_t ring; /* index of its first neighbour in rings->removed */
} ring_removal;

typedef struct rings {
    starg_context *context;
    const double *positions; /* of the mesh, borrowed */
    size_t vertex_count, left;
    ring *of;       /* per vertex; empty while removed */
    uint32_t *mark; /* per vertex; all zero between calls */
    ring removed;
    STARG_ARRAY(ring_removal) removals;
} rings;

/* The mesh must be a connected, closed, oriented 2-manifold of genus 0 without isolated vertices,
 * which is not checked; it is borrowed. Errors: MEMORY. */
starg_status rings_create(starg_context *context, const starg_mesh *mesh, rings **out);
void rings_free(rings *r);

/* Limits of the reduction; NULL: it ends with a tetrahedron. */
typedef struct rings_limits {
    size_t least;             /* minimal number of vertices, at least 4 */
    const uint8_t *kept;      /* per vertex: not removed; or NULL */
    const double *directions; /* an embedding in the sphere that must stay valid; or NULL */
} rings_limits;

/* Removes vertices, short edges first, within the limits. Errors: MEMORY, CANCELLED. */
starg_status rings_reduce(rings *r, const rings_limits *limits) STARG_PRIVATE(rings_reduce);

/* Restores the last removed vertex. Errors: MEMORY. */
starg_status rings_restore(rings *r);

#endif
