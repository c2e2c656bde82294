/* SPDX-License-Identifier: Apache-2.0 */
/* What a descriptor measures of a solid. */
#pragma once

#include "core/fields.h"
#include "star/piece_faces.h"
#include "starguard/descriptor.h"

/* ---- a model at a standard level of detail (level.c) ---- */

/* The model without detail finer than a mesh of `vertices` vertices can show: noise smoothed, at
 * most that many vertices (or nearly, if the topology needs more), local self-intersections
 * repaired. *out is NULL, without error, if the mesh is not a closed and oriented 2-manifold or
 * nothing usable results: use the mesh itself then. Errors: MEMORY, CANCELLED, TIME. */
starg_status level_create(starg_context *context, const starg_mesh *mesh, size_t vertices,
                          starg_mesh **out);

/* Without smoothing: a closed and oriented 2-manifold simplified and repaired. As above. */
starg_status level_coarsen(starg_context *context, const starg_mesh *mesh, size_t vertices,
                           starg_mesh **out);

/* ---- distance from a point inside to the boundary, in a given direction (rays.c) ---- */

typedef struct ray_caster {
    tet_sight sight;
    double length; /* longer than any ray inside */
    double scale;  /* scales differences to at most 1 */
} ray_caster;

/* The mesh must outlive it. Errors: MEMORY. */
starg_status ray_caster_create(starg_context *context, const starg_tetmesh *mesh, ray_caster *out);
void ray_caster_free(ray_caster *caster);

/* From a point strictly inside to the first boundary point; at most `length`. */
double ray_length(const ray_caster *caster, const double from[3], const double direction[3]);

/* ---- views from all over a solid (views.c) ---- */

/* STARG_DESCRIPTOR_VIEW rows of STARG_DESCRIPTOR_SPREAD lengths: row k has quantiles, over points
 * uniform in the solid, of the k-th quantile of a point's distances to the boundary. Errors:
 * MEMORY, CANCELLED. */
starg_status views_measure(starg_context *context, const starg_tetmesh *mesh,
                           const ray_caster *caster, double *out);

/* ---- field table of DESCRIPTOR.json (descriptor_fields.c) ---- */

/* Changes with what the numbers mean, even if the keys stay. */
enum { DESCRIPTOR_VERSION = 5 };

/* The file as a starg_descriptor. */
extern const starg_fields descriptor_file_fields;

STARG_DROP_RESULT(starg_descriptor)
