/* SPDX-License-Identifier: Apache-2.0 */
/* Spherical embeddings of surfaces of genus 0. */
#ifndef STARG_SPHERE_SPHERE_H
#define STARG_SPHERE_SPHERE_H

#include "sphere/rings.h"

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
void sphere_work_free(starg_context *context, sphere_work *work) STARG_PRIVATE(sphere_work_free);

/* Restores the last removed vertex, at the centre of the kernel of its polygon, and appends it to
 * `alive`. Errors: SOLVER (no room in doubles), MEMORY. */
starg_status sphere_insert(sphere *s, sphere_work *work) STARG_PRIVATE(sphere_insert);

#endif
