/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of a solid: connected components of its interior. No point sees faces of two of them,
 * so bounds for parts add up. */
#ifndef STARG_VISIBILITY_PARTS_H
#define STARG_VISIBILITY_PARTS_H

#include "mesh/solid.h"

typedef struct solid_parts {
    size_t count;
    uint32_t *of; /* by face: the part that it bounds; parts are numbered by their lowest faces */
} solid_parts;

/* Shells that intersect, or touch otherwise than in common vertices and edges, count as one part,
 * and so does a scene. Release with
 * solid_parts_free, whatever the status. Errors: MEMORY, CANCELLED, TIME. */
starg_status solid_parts_find(starg_context *context, const starg_solid *solid, solid_parts *out);
void solid_parts_free(starg_context *context, solid_parts *parts);

/* A lower bound on the number of points that see each target (bits of faces; NULL: all) `times`
 * times, wherever the points stand: so many for each part with a target. If points see faces from
 * strictly inside (`inner`), one more for each part whose kernel has no interior, where all faces
 * with an area are targets: no point sees all of them. Errors: MEMORY, CANCELLED. */
starg_status solid_parts_bound(starg_context *context, const starg_solid *solid,
                               const solid_parts *parts, const uint64_t *targets, size_t times,
                               bool inner, size_t *bound);

#endif
