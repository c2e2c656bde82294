/* SPDX-License-Identifier: Apache-2.0 */
/* The distortion of a linear map of a tetrahedron, found in another way than by the solver. */
#ifndef STARG_VERIFY_DISTORTION_H
#define STARG_VERIFY_DISTORTION_H

#include <stddef.h>

/* Sums over tetrahedra, initially zero. */
typedef struct verify_distortion {
    double worst, sum, above, all;
    double worst_room, sum_room, above_room; /* how far rounding may move them */
} verify_distortion;

/* Adds a tetrahedron and its image; coordinates are multiplied by 2^scale first. */
void verify_add_distortion(verify_distortion *own, const double *const from[4], int from_scale,
                           const double *const to[4], int to_scale);

/* Do two values agree, up to rounding, which grows as tetrahedra get flatter (`room`)? */
int verify_near_distortion(double claimed, double found, double room);

#endif
