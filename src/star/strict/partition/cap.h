/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles that fill plane loops. */
#ifndef STARG_STAR_STRICT_PARTITION_CAP_H
#define STARG_STAR_STRICT_PARTITION_CAP_H

#include "core/context.h"
#include "core/memory.h"

typedef STARG_ARRAY(uint32_t) cap_indices;

/* Loops of vertices near a plane with the given normal: `corners` holds them one after the other,
 * loop i from starts[i] to starts[i + 1] - 1. Outlines turn counter-clockwise as seen against the
 * normal, holes clockwise. Appends triangles (counter-clockwise likewise) that fill what is inside
 * of the outlines and outside of the holes. *done is false when the loops are not nested so.
 * Errors: MEMORY. */
starg_status cap_fill(starg_context *context, const double *points, const double normal[3],
                      const uint32_t *corners, const uint32_t *starts, size_t loop_count,
                      cap_indices *triangles, bool *done);

#endif
