/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra in two places, cut by planes into sets that are star-shaped in both. */
#ifndef STARG_STAR_COMPATIBLE_PLANES_H
#define STARG_STAR_COMPATIBLE_PLANES_H

#include "star/strict/start/region_growing.h"

/* Divides the tetrahedra, alike in both places: `own` are the results, and `pieces` labels them.
 * Every set is strictly star-shaped in both, about its guard and its counterpart, proven by exact
 * signs. What no plane makes so is grown (region_growing.h). Each round draws other
 * planes. Errors: MESH (a tetrahedron so thin that no point is found in it), MEMORY, CANCELLED. */
starg_status compatible_planes(starg_context *context, const starg_tetmesh *const meshes[2],
                               uint64_t round, starg_tetmesh *own[2], grown_regions *pieces);

#endif
