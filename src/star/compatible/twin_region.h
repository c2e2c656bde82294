/* SPDX-License-Identifier: Apache-2.0 */
/* Faces in one of two places as the input of a search for planes (planes.c). */
#pragma once

#include "core/rng.h"
#include "star/certified/partition.h"
#include "visibility/kernel.h"

/* To a cube of about unit size. */
typedef struct twin_frame {
    double origin[3], scale;
} twin_frame;

twin_frame twin_frame_of(const double *places, const uint32_t *corners, size_t count);
void twin_to_unit(const twin_frame *frame, const double p[3], double out[3]);

/* `corners` are those of triangles, `count` in all. Errors: MEMORY. */
starg_status twin_region(starg_context *context, const double *places, size_t vertices,
                         const uint32_t *corners, size_t count, const twin_frame *frame,
                         region *out);

/* Guards that see all of a surface in both of its places, which are looked at in a random order;
 * *blind is one where there is none, or -1. Errors: MEMORY, and those of kernel_find. */
starg_status twin_kernels(starg_context *context, const kernel_faces surfaces[2], starg_rng *rng,
                          double guards[2][3], int *blind);
