/* SPDX-License-Identifier: Apache-2.0 */
/* Candidates: points where guards may stand. */
#ifndef STARG_GUARD_CANDIDATES_H
#define STARG_GUARD_CANDIDATES_H

#include "core/memory.h"
#include "guard/weights.h"
#include "mesh/solid.h"
#include "starguard/guard.h"
#include "visibility/sensor.h"

/* Points of three doubles; data.count is three times their number. Where views are directed each
 * has a direction as well, and what is up for it (0: what the options say); else both are empty. */
typedef struct candidate_points {
    STARG_ARRAY(double) data, directions, ups;
} candidate_points;

static inline size_t candidates_count(const candidate_points *points) {
    return points->data.count / 3;
}

/* `direction` is NULL where views are not directed, `up` where the options say it. Errors: MEMORY.
 */
starg_status candidates_push_pose(starg_context *context, candidate_points *points,
                                  const double p[3], const double direction[3], const double up[3]);
starg_status candidates_push(starg_context *context, candidate_points *points, const double p[3],
                             const double direction[3]);
void candidates_free(starg_context *context, candidate_points *points);

/* Points, each with a few directions in which the views hold most of what is seen from it; of many
 * points some are left out (guard/directions.c). Errors: MEMORY, CANCELLED. */
starg_status candidates_turn(starg_context *context, const starg_solid *solid,
                             const starg_visibility_options *view, const candidate_points *points,
                             candidate_points *out);

/* May a guard stand at p: strictly inside, with the clearance? */
bool candidates_allowed(const starg_solid *solid, const double p[3], double clearance);

/* What candidates are of. */
typedef struct candidate_shape {
    const starg_solid *solid; /* what they must be inside of                               */
    const starg_solid *proxy; /* source of medial axis and skeleton: the solid or its proxy */
    double clearance;
} candidate_shape;

/* Errors: ARGUMENT (a number out of range, or candidates that cannot be made). */
starg_status candidates_check(starg_context *context, starg_candidates source, size_t wanted,
                              double clearance);

/* Adds about `wanted` points of a source, all checked. Errors: MEMORY, CANCELLED, TIME. */
starg_status candidates_find(starg_context *context, const candidate_shape *shape,
                             starg_candidates source, size_t wanted, candidate_points *points);

/* Adds candidates for faces that no candidate sees (guard/augment.c): `unseen` marks the faces (by
 * index) for which points are wanted. The points that are appended see at least one of them each; a
 * face stays unseen only if none of the points tried sees it. Does at most a bounded number of
 * faces per call: `pending` tells whether there are more to try. */
typedef struct augmentation {
    const starg_solid *solid;
    const starg_visibility_options *visibility;
    double clearance;
    uint8_t *tried; /* per face: points were looked for already */
} augmentation;

starg_status augment_candidates(starg_context *context, const augmentation *augmentation,
                                const uint8_t *unseen, candidate_points *points, bool *pending);

#endif
