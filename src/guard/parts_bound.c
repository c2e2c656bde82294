/* SPDX-License-Identifier: Apache-2.0 */
/* A lower bound for guards anywhere that costs next to nothing: each part of the solid needs as
 * many as must see a face, and one more if its kernel has no interior (visibility/kernel.h). What
 * must be seen is what enough candidates see. Cost: O(n) for each candidate, and a linear program
 * for each part. */
#include "guard/stages.h"
#include "visibility/kernel.h"

static const char STAGE[] = "guard";

/* By column: do as many candidates see it as have to? */
static starg_status find_required(const guard_pool *pool, size_t times, uint64_t **out) {
    SCOPED uint32_t *supply = NULL;
    TRY(pool_supply(pool, &supply));
    NEW_ZERO(pool->context, STAGE, *out, starg_bit_words(pool->columns));
    for (size_t j = 0; j < pool->columns; j++)
        if (supply[j] >= times)
            starg_bit_set(*out, j);
    return STARG_OK;
}

/* Are all patches of the face required, or one of its vertices, or all of its corners? */
static bool is_required(const guard_pool *pool, const uint64_t *required, size_t face) {
    const starg_solid *solid = pool->solid;
    const uint32_t *c = solid->mesh->faces + 3 * face;
    bool all = true;
    switch (pool->options->visibility.target) {
    case STARG_TARGET_VERTICES:
        return starg_bit_test(required, c[0]) || starg_bit_test(required, c[1]) ||
               starg_bit_test(required, c[2]);
    case STARG_TARGET_CORNERS:
        return starg_bit_test(required, 3 * face) && starg_bit_test(required, 3 * face + 1) &&
               starg_bit_test(required, 3 * face + 2);
    default:
        for (size_t j = solid_first_patch(solid, face); j < solid_first_patch(solid, face + 1); j++)
            all = all && starg_bit_test(required, j);
        return all;
    }
}

starg_status bound_by_parts(const guard_problem *problem, const guard_pool *pool, size_t *bound) {
    starg_context *context = problem->context;
    const starg_solid *solid = problem->solid;
    SCOPED uint64_t *required = NULL, *faces = NULL;
    SCOPED_BY(solid_parts_free) solid_parts parts = {0};
    size_t times = problem->kept == NULL || problem->kept->even ? problem->options->redundancy : 1;
    bool inner = !solid->scene && problem->options->visibility.target != STARG_TARGET_VERTICES;
    TRY(find_required(pool, times, &required));
    NEW_ZERO(context, STAGE, faces, starg_bit_words(solid->mesh->face_count));
    for (size_t f = 0; f < solid->mesh->face_count; f++)
        if (is_required(pool, required, f))
            starg_bit_set(faces, f);
    TRY(solid_parts_find(context, solid, &parts));
    return solid_parts_bound(context, solid, &parts, faces, times, inner, bound);
}
