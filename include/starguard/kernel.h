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
    STARG_KERNEL_INTERIOR = 0, /* the guard is proven to lie in the interior of the kernel */
    STARG_KERNEL_EMPTY = 1, /* the witness proves that the kernel has no interior                */
    STARG_KERNEL_UNDECIDED =
        2 /* neither is proven: the kernel is about as small as rounding errors */
} starg_kernel_verdict;

enum { STARG_KERNEL_WITNESS = 4 };

typedef struct starg_kernel_result {
    starg_kernel_verdict verdict;
    /* Centre of the largest ball in the kernel, and how far it is from the nearest of the planes of
     * all faces: the radius of that ball, rounded. Where the kernel is empty: the point that lies
     * least far behind a plane, and minus that distance. Never decides the verdict. */
    double guard[3], radius;
    /* Only when EMPTY: faces such that no point of the mesh's bounding box is strictly on the inner
     * side of all of them. */
    size_t witness_count;
    uint32_t witness[STARG_KERNEL_WITNESS];
} starg_kernel_result;

typedef struct starg_kernel_options {
    bool trust_closed; /* the caller knows that the mesh is closed: do not check (default false) */
} starg_kernel_options;

STARG_API void starg_kernel_options_default(starg_kernel_options *options);

/* Finds the kernel of the solid that a closed, outward oriented mesh bounds. The verdict INTERIOR
 * is a proof in exact arithmetic that the mesh is embedded and the guard sees every point of the
 * solid: the guard is strictly on the inner side of every face and the mesh winds around it once.
 * EMPTY is proven just so, by the inner sides of at most four faces, or by a mesh that winds more
 * than once around the points on the inner side of all faces.
 * (A face without area has no inner side: then EMPTY, with that face as the witness.)
 * `options` may be NULL. Takes 0.1 to 0.5 s for a million faces.
 * Errors: MESH (no faces; edges that do not have as many faces one way as the other, with their
 * vertices), MEMORY, CANCELLED. */
STARG_API starg_status starg_kernel(starg_context *context, const starg_mesh *mesh,
                                    const starg_kernel_options *options,
                                    starg_kernel_result *result);

#ifdef __cplusplus
}
#endif

#endif
