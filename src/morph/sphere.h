/* Surfaces of genus 0 spread over the unit sphere. */
#ifndef STARG_MORPH_SPHERE_H
#define STARG_MORPH_SPHERE_H

#include "morph/rings.h"

/* A bijection between a surface and the sphere, given by the directions of its vertices: the
 * spherical triangles of the faces are all positively oriented (exactly: det(a, b, c) > 0 of the
 * doubles as they are) and cover the sphere once. */
typedef struct sphere {
    starg_context *context;
    const starg_mesh *mesh; /* borrowed; every coordinate within about a unit */
    rings *rings;           /* with all vertices                              */
    uint32_t *alive;        /* 0, 1, ..: all vertices                         */
    double *directions;     /* vertex_count x 3, of length about 1            */
    double floor;           /* of its relaxation                              */
} sphere;

/* Spreads a mesh whose genus, orientation and single part the caller has checked.
 * Errors: SOLVER (too uneven for doubles), MEMORY, CANCELLED. */
starg_status sphere_create(starg_context *context, const starg_mesh *mesh, sphere **out);
void sphere_free(sphere *s);

/* Is every face positively oriented? Exact. */
bool sphere_is_positive(const sphere *s);

#endif
