/* SPDX-License-Identifier: Apache-2.0 */
/* The kernel of a solid: the points that see all of it. A solid whose kernel has an interior is
 * called strictly star-shaped here. */
#ifndef STARGUARD_KERNEL_H
#define STARGUARD_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum starg_kernel_verdict {
    STARG_KERNEL_INTERIOR = 0, /* proven: the guard is in the interior of the kernel */
    STARG_KERNEL_EMPTY = 1,    /* proven by the witness: the kernel has no interior */
    STARG_KERNEL_UNDECIDED = 2 /* not proven: the kernel is as small as rounding errors */
} starg_kernel_verdict;

enum { STARG_KERNEL_WITNESS = 4 };

typedef struct starg_kernel_result {
    starg_kernel_verdict verdict;
    /* Centre of the largest ball in the kernel, and its radius (the rounded distance to the nearest
     * face plane). For an empty kernel: the point least far behind a plane, and minus that
     * distance. The verdict does not depend on them. */
    double guard[3], radius;
    /* EMPTY: faces such that no point of the mesh's bounding box is strictly on the inner side of
     * all of them. */
    size_t witness_count;
    uint32_t witness[STARG_KERNEL_WITNESS];
} starg_kernel_result;

typedef struct starg_kernel_options {
    bool trust_closed; /* the mesh is known to be closed: skip the check (default false) */
} starg_kernel_options;

STARG_API void starg_kernel_options_default(starg_kernel_options *options);

/* Computes the kernel of the solid bounded by a closed, outward oriented mesh. The verdict INTERIOR
 * is an exact proof that the mesh is embedded and that the guard sees every point of the solid: the
 * guard is strictly on the inner side of every face, and the mesh winds around it once. EMPTY is
 * proven as well, by the inner sides of at most four faces, or by a mesh that winds more than once
 * around the points on the inner side of all faces. (A degenerate face has no inner side: then
 * EMPTY, with that face as the witness.) `options` may be NULL. Takes 0.1 to 0.5 s for a million
 * faces. Errors: MESH (no faces; edges with different numbers of faces in each direction, with
 * their vertices), MEMORY, CANCELLED. */
STARG_API starg_status starg_kernel(starg_context *context, const starg_mesh *mesh,
                                    const starg_kernel_options *options,
                                    starg_kernel_result *result);

#ifdef __cplusplus
}
#endif

#endif
