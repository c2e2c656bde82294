/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates: points where guards may stand. */
#ifndef STARG_GUARD_CANDIDATES_H
#define STARG_GUARD_CANDIDATES_H

#include "core/memory.h"
#include "guard/weights.h"
#include "mesh/solid.h"
#include "starguard/guard.h"
#include "visibility/sensor.h"

/* Points of three doubles; data.count is three times their number. If views are directed, each
 * point also has a direction and an up vector (0: from the options); otherwise both are empty. */
typedef struct candidate_points {
    STARG_ARRAY(double) data, directions, ups;
} candidate_points;

/* Appends all points of `from`. Errors: MEMORY. */
starg_status candidates_append(starg_context *context, const candidate_points *from,
                               candidate_points *out);

static inline size_t candidates_count(const candidate_points *points) {
    return points->data.count / 3;
}

/* `direction` is NULL if views are not directed, `up` if the options define it. Errors: MEMORY. */
starg_status candidates_push_pose(starg_context *context, candidate_points *points,
                                  const double p[3], const double direction[3], const double up[3]);
starg_status candidates_push(starg_context *context, candidate_points *points, const double p[3],
                             const double direction[3]);
void candidates_free(candidate_points *points);

/* Points, each with a few directions whose views hold most of what the point sees; a large set of
 * points is thinned out (guard/directions.c). Errors: MEMORY, CANCELLED. */
starg_status candidates_turn(starg_context *context, const starg_solid *solid,
                             const starg_visibility_options *view, const candidate_points *points,
                             candidate_points *out);

/* May a guard stand at p: strictly inside, with the clearance? */
bool candidates_allowed(const starg_solid *solid, const double p[3], double clearance);

/* What candidates are generated for. */
typedef struct candidate_shape {
    const starg_solid *solid; /* candidates must be inside it */
    const starg_solid *proxy; /* source of medial axis and skeleton: the solid or its proxy */
    double clearance;
} candidate_shape;

/* Errors: ARGUMENT (a number out of range, or candidates that cannot be made). */
starg_status candidates_check(starg_context *context, starg_candidates source, size_t wanted,
                              double clearance);

/* The same where guards are bound to faces (guard/near_candidates.c). */
starg_status near_candidates(starg_context *context, const candidate_shape *shape, size_t wanted,
                             candidate_points *points);

/* There, places nearest to patches that no candidate sees, at most two for each, if they see it in
 * some direction. */
starg_status near_candidates_before(starg_context *context, const candidate_shape *shape,
                                    const starg_visibility_options *view, const uint32_t *patches,
                                    size_t count, candidate_points *points);

/* Adds about `wanted` points of a source, all allowed. Errors: MEMORY, CANCELLED, TIME. */
starg_status candidates_find(starg_context *context, const candidate_shape *shape,
                             starg_candidates source, size_t wanted, candidate_points *points);

/* Adds candidates for patches that no candidate sees (guard/augment.c): `unseen` marks them (by
 * index). Each appended point sees at least one of them; a patch stays unseen only if none of the
 * points tried sees it. Handles a bounded number of patches per call: `pending` tells whether
 * more remain. */
typedef struct augmentation {
    const starg_solid *solid;
    const starg_visibility_options *visibility;
    double clearance;
    uint8_t *tried; /* by patch: points were already tried */
} augmentation;

/* Tries all these patches at once. Those that some point sees are listed, with the deepest such
 * point of each, which is not added: `patches` has one for each pose. Errors: MEMORY, CANCELLED,
 * TIME.
 */
typedef struct augmentation_finds {
    candidate_points poses;
    STARG_ARRAY(uint32_t) patches;
} augmentation_finds;

starg_status augment_test(starg_context *context, const augmentation *augmentation,
                          const uint8_t *unseen, augmentation_finds *out);
void augment_finds_free(augmentation_finds *finds);

starg_status augment_candidates(starg_context *context, const augmentation *augmentation,
                                const uint8_t *unseen, candidate_points *points, bool *pending);

#endif
