/* SPDX-License-Identifier: Apache-2.0 */
/* A solid: a mesh that has passed the check, with every shell turned so that faces point out of
 * it (inward at the wall of a cavity), and the search structures that all later stages share. */
#ifndef STARGUARD_SOLID_H
#define STARGUARD_SOLID_H

#include <stdbool.h>

#include "check.h"
#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_solid starg_solid;

/* Makes a solid of a mesh, which is copied. Inward shells are turned, with a notice; a mesh that
 * intersects itself is taken as it is, with a warning. Vertices and faces keep their numbers; where
 * the mesh is closed and manifold only once vertices at exactly equal positions are one, faces name
 * the first of these, with a notice.
 * Errors: MESH (not closed, not manifold, not oriented: with indices; no volume: without), RANGE
 * (narrower than 1e-90), MEMORY. */
STARG_API starg_status starg_solid_create(starg_context *context, const starg_mesh *mesh,
                                          starg_solid **out);
STARG_API void starg_solid_free(starg_solid *solid);

/* Both owned by the solid. The check describes the mesh before shells were turned. */
STARG_API const starg_mesh *starg_solid_mesh(const starg_solid *solid);
STARG_API const starg_check *starg_solid_check(const starg_solid *solid);

/* Is p strictly inside: off the surface, and with a winding number of at least one? Exact. */
STARG_API bool starg_solid_contains(const starg_solid *solid, const double p[3]);

/* Distance from p to the surface, rounded. */
STARG_API double starg_solid_distance(const starg_solid *solid, const double p[3]);

#ifdef __cplusplus
}
#endif

#endif
