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
    starg_status status = STARG_OK;
    uint32_t *supply = NULL;
    STARG_TRY(pool_supply(pool, &supply));
    STARG_NEW_ZERO(pool->context, STAGE, *out, starg_bit_words(pool->columns));
    for (size_t j = 0; j < pool->columns; j++)
        if (supply[j] >= times)
            starg_bit_set(*out, j);
done:
    starg_release(pool->context, supply);
    return status;
}

/* Is the face required, or one of its vertices, or all of its corners? */
static bool is_required(const guard_pool *pool, const uint64_t *required, size_t face) {
    const uint32_t *c = pool->solid->mesh->faces + 3 * face;
    switch (pool->options->visibility.target) {
    case STARG_TARGET_VERTICES:
        return starg_bit_test(required, c[0]) || starg_bit_test(required, c[1]) ||
               starg_bit_test(required, c[2]);
    case STARG_TARGET_CORNERS:
        return starg_bit_test(required, 3 * face) && starg_bit_test(required, 3 * face + 1) &&
               starg_bit_test(required, 3 * face + 2);
    default:
        return starg_bit_test(required, face);
    }
}

starg_status bound_by_parts(const guard_problem *problem, const guard_pool *pool, size_t *bound) {
    starg_status status = STARG_OK;
    starg_context *context = problem->context;
    const starg_solid *solid = problem->solid;
    uint64_t *required = NULL, *faces = NULL;
    solid_parts parts = {0};
    bool inner = !solid->scene && problem->options->visibility.target != STARG_TARGET_VERTICES;
    STARG_TRY(find_required(pool, problem->options->redundancy, &required));
    STARG_NEW_ZERO(context, STAGE, faces, starg_bit_words(solid->mesh->face_count));
    for (size_t f = 0; f < solid->mesh->face_count; f++)
        if (is_required(pool, required, f))
            starg_bit_set(faces, f);
    STARG_TRY(solid_parts_find(context, solid, &parts));
    STARG_TRY(solid_parts_bound(context, solid, &parts, faces, problem->options->redundancy, inner,
                                bound));
done:
    solid_parts_free(context, &parts);
    starg_release(context, required);
    starg_release(context, faces);
    return status;
}
