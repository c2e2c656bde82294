/* SPDX-License-Identifier: Apache-2.0 */
/* Distance from an interior point to the boundary of a tetrahedral mesh, in a given direction. */
#ifndef STARG_SHAPE_RAYS_H
#define STARG_SHAPE_RAYS_H

#include "star/sight.h"

typedef struct ray_caster {
    tet_sight sight;
    double length; /* longer than any ray inside */
    double scale;  /* scales differences to at most 1 */
} ray_caster;

/* The mesh must outlive it. Errors: MEMORY. */
starg_status ray_caster_create(starg_context *context, const starg_tetmesh *mesh, ray_caster *out);
void ray_caster_free(starg_context *context, ray_caster *caster);

/* From a point strictly inside to the first boundary point; at most `length`. */
double ray_length(const ray_caster *caster, const double from[3], const double direction[3]);

#endif
