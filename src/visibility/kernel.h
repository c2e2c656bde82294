/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the kernel: the same for oriented triangles that are not a mesh, such as the
 * boundary of a set of tetrahedra. */
#ifndef STARG_VISIBILITY_KERNEL_H
#define STARG_VISIBILITY_KERNEL_H

#include "core/compiler.h"
#include "core/context.h"
#include "mesh/solid.h"
#include "starguard/kernel.h"

typedef struct kernel_faces {
    const double *vertices;
    const uint32_t *faces; /* count x 3, valid, counter-clockwise seen from outside */
    size_t count;
} kernel_faces;

/* starg_kernel for a set of faces whose edges cancel. Errors: MEMORY, CANCELLED. */
starg_status kernel_find(starg_context *context, const kernel_faces *surface,
                         starg_kernel_result *result) STARG_PRIVATE(kernel_find);

/* Is `point` strictly on the inner side of every face? Exact. */
bool kernel_sees_all(const kernel_faces *surface, const double point[3])
    STARG_PRIVATE(kernel_sees_all);

/* Winding number of the faces about a point on none of them. Exact. */
int kernel_winding(const kernel_faces *surface, const double point[3])
    STARG_PRIVATE(kernel_winding);

/* ---- the parts of a solid: connected components of its interior (parts.c) ---- */
/* No point sees faces of two of them, so bounds for parts add up. */

typedef struct solid_parts {
    size_t count;
    uint32_t *of; /* by face: the part that it bounds; parts are numbered by their lowest faces */
} solid_parts;

/* Shells that intersect, or touch otherwise than in common vertices and edges, count as one part,
 * and so does a scene. Release with
 * solid_parts_free, whatever the status. Errors: MEMORY, CANCELLED, TIME. */
starg_status solid_parts_find(starg_context *context, const starg_solid *solid, solid_parts *out);
void solid_parts_free(solid_parts *parts);

/* A lower bound on the number of points that see each target (bits of faces; NULL: all) `times`
 * times, wherever the points stand: so many for each part with a target. If points see faces from
 * strictly inside (`inner`), one more for each part whose kernel has no interior, where all faces
 * with an area are targets: no point sees all of them. Errors: MEMORY, CANCELLED. */
starg_status solid_parts_bound(starg_context *context, const starg_solid *solid,
                               const solid_parts *parts, const uint64_t *targets, size_t times,
                               bool inner, size_t *bound);

#endif
