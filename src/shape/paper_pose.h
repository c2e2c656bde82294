/* SPDX-License-Identifier: Apache-2.0 */
/* Normalizes a descriptor for position, size and orientation. */
#ifndef STARG_SHAPE_PAPER_POSE_H
#define STARG_SHAPE_PAPER_POSE_H

#include "starguard/descriptor.h"

typedef struct paper_pose {
    double centre[3];  /* of the points that the guards see */
    double size;       /* root mean square distance from it; 0 if they coincide */
    double axes[3][3]; /* rows: the principal axes, a right-handed frame */
} paper_pose;

paper_pose paper_pose_of(const starg_descriptor *descriptor);

/* Maps a point to the frame, in units of the size. */
void paper_pose_apply(const paper_pose *pose, const double p[3], double out[3]);

#endif
