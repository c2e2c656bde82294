/* SPDX-License-Identifier: Apache-2.0 */
/* A first division of tetrahedra into star-shaped sets. */
#pragma once

#include "tetra/tetmesh.h"

typedef struct grown_regions {
    uint32_t *labels; /* one per tetrahedron: 0 to count - 1 */
    size_t count;
    STARG_ARRAY(double) guards;       /* count x 3, each strictly inside the kernel of its set */
    STARG_ARRAY(double) counterparts; /* the same for the image; empty without one */
} grown_regions;

/* Every set is connected and strictly star-shaped, with its guard strictly inside its kernel:
 * proven by exact signs. `hints` are points (hint_count x 3, any) that are tried as guards. Errors:
 * MESH (a tetrahedron so thin that no point is found in it), MEMORY, CANCELLED. When the time
 * limit has passed, guards no longer climb. */
starg_status grow_regions(starg_context *context, const starg_tetmesh *mesh, const double *hints,
                          size_t hint_count, grown_regions *out);

/* The same for a mesh and its image, the same tetrahedra in other places: every set is strictly
 * star-shaped in both. Errors: as above. */
starg_status grow_compatible_regions(starg_context *context, const starg_tetmesh *mesh,
                                     const starg_tetmesh *image, grown_regions *out);

/* The same, where the regions of `former` stay that are not dropped (a byte each), as the first in
 * their order; the rest is grown anew, in another way for each round. */
starg_status grow_compatible_again(starg_context *context, const starg_tetmesh *mesh,
                                   const starg_tetmesh *image, const grown_regions *former,
                                   const uint8_t *dropped, uint64_t round, grown_regions *out);
void grown_regions_free(grown_regions *regions);
