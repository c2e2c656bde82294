/* Candidates: points where guards may stand. */
#ifndef STARG_GUARD_CANDIDATES_H
#define STARG_GUARD_CANDIDATES_H

#include "core/memory.h"
#include "mesh/solid.h"
#include "starguard/guard.h"

/* Points of three doubles; data.count is three times their number. */
typedef struct candidate_points {
    STARG_ARRAY(double) data;
} candidate_points;

starg_status candidates_push(starg_context *context, candidate_points *points, const double p[3]);

/* Adds candidates for faces that no candidate sees (guard/complete.c): `unseen` marks the faces
 * (by index) for which points are wanted. The points that are appended see at least one of them
 * each; a face stays unseen only if none of the points tried sees it. Does at most a bounded
 * number of faces per call: `pending` tells whether there are more to try. */
typedef struct completion {
    const starg_solid *solid;
    const starg_visibility_options *visibility;
    double clearance;
    uint8_t *tried; /* per face: points were looked for already */
} completion;

starg_status complete_candidates(starg_context *context, const completion *completion,
                                 const uint8_t *unseen, candidate_points *points, bool *pending);

#endif
