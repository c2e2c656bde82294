/* SPDX-License-Identifier: Apache-2.0 */
/* Sight inside of a tetrahedral mesh: its boundary alone blocks it. */
#ifndef STARG_STAR_SIGHT_H
#define STARG_STAR_SIGHT_H

#include "core/private.h"
#include "geometry/bvh.h"
#include "tetra/tetmesh.h"

typedef struct tet_sight {
    uint32_t *faces; /* of the boundary, outward */
    bvh *tree;       /* of them */
} tet_sight;

/* The mesh must outlive it; vertices inside may move. Errors: MEMORY. */
starg_status tet_sight_create(starg_context *context, const starg_tetmesh *mesh, tet_sight *out)
    STARG_PRIVATE(tet_sight_create);
void tet_sight_free(starg_context *context, tet_sight *sight) STARG_PRIVATE(tet_sight_free);

/* Is p strictly inside of the mesh? Exact. */
bool tet_sight_contains(const tet_sight *sight, const double p[3]);

/* Does the boundary leave the segment [p, q) free? Then p, strictly inside, sees q. Exact. */
bool tet_sight_is_free(const tet_sight *sight, const double p[3], const double q[3]);

#endif
