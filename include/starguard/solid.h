/* SPDX-License-Identifier: Apache-2.0 */
/* A solid: a checked mesh with every shell oriented outward (at a cavity: towards the cavity), and
 * the search structures that later stages share. */
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

/* Creates a solid from a copy of a mesh. Inward shells are reversed, with a notice;
 * self-intersections are accepted, with a warning. Vertices and faces keep their numbers. If the
 * mesh is closed and manifold only after merging vertices at exactly equal positions, faces use the
 * first of these, with a notice. Parts may share vertices and edges where they touch. Errors: MESH
 * (not closed, faces at an edge or a vertex that do not match, not oriented: with indices; no
 * volume: without), RANGE (narrower than 1e-90), MEMORY. */
STARG_API starg_status starg_solid_create(starg_context *context, const starg_mesh *mesh,
                                          starg_solid **out);
STARG_API void starg_solid_free(starg_solid *solid);

/* Both owned by the solid. The check describes the mesh before shells were reversed, with vertices
 * of their own for all parts that share some. */
STARG_API const starg_mesh *starg_solid_mesh(const starg_solid *solid);
STARG_API const starg_check *starg_solid_check(const starg_solid *solid);

/* Whether p is strictly inside: not on the surface, with a winding number of at least one. Exact.
 */
STARG_API bool starg_solid_contains(const starg_solid *solid, const double p[3]);

/* Distance from p to the surface, rounded. */
STARG_API double starg_solid_distance(const starg_solid *solid, const double p[3]);

#ifdef __cplusplus
}
#endif

#endif
