/* SPDX-License-Identifier: Apache-2.0 */
/* Do guards together see every point of the targets? */
#ifndef STARG_GUARD_POINT_COVERAGE_H
#define STARG_GUARD_POINT_COVERAGE_H

#include "core/memory.h"
#include "mesh/patches.h"
#include "starguard/visibility.h"

/* What is known of points. */
typedef struct point_coverage {
    double *share; /* by guard and face, guard by guard: of the face's area, the parts that it is
                      the first to see whole */
    double *open;  /* by face: the share that is not decided */
    face_points unseen; /* points that no guard sees, a few of each face */
} point_coverage;

/* `count` guards as in starg_visibility; `view` has their directions. Errors: MEMORY, CANCELLED. */
starg_status point_coverage_find(starg_context *context, const starg_solid *solid,
                                 const double *guards, size_t count,
                                 const starg_visibility_options *view, point_coverage *out);
void point_coverage_free(point_coverage *coverage);

#endif
