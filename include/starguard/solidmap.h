/* SPDX-License-Identifier: Apache-2.0 */
/* Maps between solids: one set of tetrahedra, positive in both. The map itself, starg_solid_map, is
 * declared in verify.h with its reader and its check. */
#ifndef STARGUARD_SOLIDMAP_H
#define STARGUARD_SOLIDMAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"
#include "morph.h"
#include "verify.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_solid_map_options {
    size_t steps;   /* of descent in each solid, to lower the distortion; 0: none */
    double density; /* initial tetrahedra per vertex of A's surface */
} starg_solid_map_options;

/* 400 steps, density 1. */
STARG_API void starg_solid_map_options_default(starg_solid_map_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_solid_map_options_fields(void);

/* Maps the solid A to the solid whose surface has A's faces and its vertices at `images`
 * (vertex_count x 3), of any genus. TetGen fills A and keeps its surface; inner vertices then take
 * places in both solids such that every tetrahedron is positive in both, exactly. Since its
 * boundary is the surface of either, the map is a homeomorphism. `options` may be NULL. Errors:
 * ARGUMENT, RANGE, MESH (an end is no solid or meets itself; tetrahedra cannot be kept positive:
 * how many), SOLVER (no TetGen), MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_solid_map_create(starg_context *context, const starg_mesh *a,
                                              const double *images,
                                              const starg_solid_map_options *options,
                                              starg_solid_map **out);

/* The map of a morph of method solid, with its keys. Errors: ARGUMENT (another method), MEMORY,
 * CANCELLED. */
STARG_API starg_status starg_morph_solid_map(const starg_morph *morph, starg_solid_map **out);

/* Writes MAP.vtu (docs/formats.md). "-" is standard output. Errors: WRITE, MEMORY, CANCELLED. */
STARG_API starg_status starg_solid_map_write(starg_context *context, const starg_solid_map *map,
                                             const char *path);

#ifdef __cplusplus
}
#endif

#endif
