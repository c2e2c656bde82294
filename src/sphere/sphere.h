/* SPDX-License-Identifier: Apache-2.0 */
/* Maps of closed surfaces of genus 0 to the sphere. */
#pragma once

#include "mesh/mesh.h"

/* ---- a closed triangulated sphere with removable vertices (rings.c) ---- */

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
STARG_DROP(rings, rings)

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

/* ---- an embedding of a triangulated sphere in the unit sphere, relaxed (relax.c) ---- */

typedef struct relaxation {
    const rings *rings;
    double *directions;    /* vertex_count x 3, of length about 1; changed in place */
    const uint32_t *alive; /* the movable vertices, in the order of moving */
    size_t alive_count;
    const uint8_t *pinned; /* per vertex: fixed; NULL: none */
    double floor;          /* squared length added to every edge of the surface */
} relaxation;

/* Moves each vertex downhill once. Its triangles stay positive, exactly. */
void relax_sweep(const relaxation *relaxation);

/* Is every triangle at a vertex positive as seen from outside? Exact. */
bool relax_is_positive(const ring *around, const double *directions, const double at[3])
    STARG_PRIVATE(relax_is_positive);

/* ---- spherical embeddings of surfaces of genus 0 (sphere.c) ---- */

/* A bijection between a surface and the sphere, given by the directions of its vertices: the
 * spherical triangles of the faces are all positive (exactly: det(a, b, c) > 0 in doubles) and
 * cover the sphere once. */
typedef struct sphere {
    starg_context *context;
    const starg_mesh *mesh; /* borrowed; coordinates of about unit size */
    rings *rings;           /* complete except during changes */
    uint32_t *alive;        /* rings->left vertices: those not removed */
    double *directions;     /* vertex_count x 3, of length about 1 */
    double floor;           /* for relaxation */
} sphere;

/* Embeds a mesh; the caller has checked that it is connected, oriented and of genus 0. Errors:
 * SOLVER (too uneven for doubles), MEMORY, CANCELLED. */
starg_status sphere_create(starg_context *context, const starg_mesh *mesh, sphere **out)
    STARG_PRIVATE(sphere_create);

/* The same by relaxing directions that are such a bijection already. */
starg_status sphere_even(starg_context *context, const starg_mesh *mesh, const double *directions,
                         sphere **out);
void sphere_free(sphere *s) STARG_PRIVATE(sphere_free);
STARG_DROP(sphere, sphere)

/* Is every present face positive? Exact. */
bool sphere_is_positive(const sphere *s) STARG_PRIVATE(sphere_is_positive);

/* Lists the present vertices, ascending. */
void sphere_list_alive(sphere *s) STARG_PRIVATE(sphere_list_alive);

/* Relaxes the present vertices except the pinned ones (NULL: none). Errors: CANCELLED. */
starg_status sphere_relax(sphere *s, const uint8_t *pinned, int sweeps) STARG_PRIVATE(sphere_relax);

/* Work space that grows with the largest polygon; initially zero. */
typedef struct sphere_work {
    STARG_ARRAY(double) rows;
    STARG_ARRAY(uint32_t) order;
} sphere_work;
void sphere_work_free(sphere_work *work) STARG_PRIVATE(sphere_work_free);

/* Restores the last removed vertex, at the centre of the kernel of its polygon, and appends it to
 * `alive`. Errors: SOLVER (no room in doubles), MEMORY. */
starg_status sphere_insert(sphere *s, sphere_work *work) STARG_PRIVATE(sphere_insert);
