/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces of genus 0 spread over the unit sphere. */
#ifndef STARG_SPHERE_SPHERE_H
#define STARG_SPHERE_SPHERE_H

#include "sphere/rings.h"

/* A bijection between a surface and the sphere, given by the directions of its vertices: the
 * spherical triangles of the faces are all positively oriented (exactly: det(a, b, c) > 0 of the
 * doubles as they are) and cover the sphere once. */
typedef struct sphere {
    starg_context *context;
    const starg_mesh *mesh; /* borrowed; every coordinate within about a unit */
    rings *rings;           /* with all vertices, but while it is changed     */
    uint32_t *alive;        /* rings->left vertices: those that are not out   */
    double *directions;     /* vertex_count x 3, of length about 1            */
    double floor;           /* of its relaxation                              */
} sphere;

/* Spreads a mesh whose genus, orientation and single part the caller has checked.
 * Errors: SOLVER (too uneven for doubles), MEMORY, CANCELLED. */
starg_status sphere_create(starg_context *context, const starg_mesh *mesh, sphere **out)
    STARG_PRIVATE(sphere_create);

/* The same by evening out directions that are such a bijection already. */
starg_status sphere_even(starg_context *context, const starg_mesh *mesh, const double *directions,
                         sphere **out);
void sphere_free(sphere *s) STARG_PRIVATE(sphere_free);

/* Is every face positively oriented, of what is not out? Exact. */
bool sphere_is_positive(const sphere *s) STARG_PRIVATE(sphere_is_positive);

/* Lists the vertices that are not out, in ascending order. */
void sphere_list_alive(sphere *s) STARG_PRIVATE(sphere_list_alive);

/* Evens out what is not out, but for the vertices that are pinned (NULL: none). Errors: CANCELLED.
 */
starg_status sphere_relax(sphere *s, const uint8_t *pinned, int sweeps) STARG_PRIVATE(sphere_relax);

/* Memory that grows with the largest polygon; zero at first. */
typedef struct sphere_work {
    STARG_ARRAY(double) rows;
    STARG_ARRAY(uint32_t) order;
} sphere_work;
void sphere_work_free(starg_context *context, sphere_work *work) STARG_PRIVATE(sphere_work_free);

/* Puts the last removed vertex back, into the middle of the kernel of its polygon, and at the end
 * of `alive`. Errors: SOLVER (no room in doubles), MEMORY. */
starg_status sphere_insert(sphere *s, sphere_work *work) STARG_PRIVATE(sphere_insert);

#endif
