/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the kernel: the same for oriented triangles that are not a mesh, such as the
 * boundary of a set of tetrahedra. */
#ifndef STARG_VISIBILITY_KERNEL_H
#define STARG_VISIBILITY_KERNEL_H

#include "core/context.h"
#include "starguard/kernel.h"

typedef struct kernel_faces {
    const double *vertices;
    const uint32_t *faces; /* count x 3, valid, counter-clockwise seen from outside */
    size_t count;
} kernel_faces;

/* starg_kernel for a set of faces whose edges cancel. Errors: MEMORY, CANCELLED. */
starg_status kernel_find(starg_context *context, const kernel_faces *surface,
                         starg_kernel_result *result);

/* Is `point` strictly on the inner side of every face? Exact. */
bool kernel_sees_all(const kernel_faces *surface, const double point[3]);

/* Winding number of the faces about a point on none of them. Exact. */
int kernel_winding(const kernel_faces *surface, const double point[3]);

#endif
