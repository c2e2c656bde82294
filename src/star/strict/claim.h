/* A first division of tetrahedra into star-shaped sets. */
#ifndef STARG_STAR_STRICT_CLAIM_H
#define STARG_STAR_STRICT_CLAIM_H

#include "core/context.h"
#include "core/memory.h"
#include "tetra/tetmesh.h"

typedef struct claims {
    uint32_t *labels; /* one per tetrahedron: 0 to count - 1 */
    size_t count;
    STARG_ARRAY(double) guards;       /* count x 3, each strictly inside the kernel of its set */
    STARG_ARRAY(double) counterparts; /* the same for the twin; empty without one */
} claims;

/* Every set is connected and strictly star-shaped, with its guard strictly inside its kernel:
 * proven by exact signs. `hints` are points (hint_count x 3, any) that are tried as guards. Errors:
 * MESH (a tetrahedron so thin that no point is found in it), MEMORY, CANCELLED. When the time
 * limit has passed, guards no longer climb. */
starg_status claim_all(starg_context *context, const starg_tetmesh *mesh, const double *hints,
                       size_t hint_count, claims *out);

/* The same for a mesh and its twin, the same tetrahedra in other places: every set is strictly
 * star-shaped in both. Errors: as above. */
starg_status claim_twins(starg_context *context, const starg_tetmesh *mesh,
                         const starg_tetmesh *twin, claims *out);
void claims_free(starg_context *context, claims *claimed);

#endif
