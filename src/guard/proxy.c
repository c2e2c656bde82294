/* SPDX-License-Identifier: Apache-2.0 */
/* Proxy level: a large model takes its medial axis from a level of detail, the coarsest that has
 * enough vertices, because more than a few thousand points add nothing. Cost: that of the
 * levels. */
#include "guard/candidates.h"

#include "starguard/guard.h"

enum { STEP = 10000, LARGE = 40000, MANY = 100000, ENOUGH = 25000, COARSEST = 5000 };

size_t starg_guard_default_step(size_t vertices, size_t coarsest) {
    return vertices > coarsest && vertices - coarsest > LARGE ? STARG_QUARTERS : STEP;
}

bool proxy_wanted(const starg_solid *solid) {
    return solid->mesh->vertex_count > MANY;
}

starg_status proxy_of_levels(starg_context *context, const starg_solid *solid,
                             const starg_levels *levels, starg_solid **out) {
    size_t level = 0;
    while (level + 1 < levels->count && levels->levels[level].mesh->vertex_count < ENOUGH)
        level++;
    const starg_mesh *mesh = levels->levels[level].mesh;
    return solid->check->embedded ? solid_of_level(context, solid, mesh, out)
                                  : solid_make(context, mesh, out);
}

starg_status proxy_make(starg_context *context, const starg_solid *solid, starg_solid **out) {
    SCOPED_BY(starg_levels_drop) starg_levels *levels = NULL;
    size_t step = starg_guard_default_step(solid->mesh->vertex_count, COARSEST);
    TRY(starg_mesh_levels(context, solid->mesh, COARSEST, step, NULL, &levels));
    return proxy_of_levels(context, solid, levels, out);
}
