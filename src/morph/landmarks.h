/* Landmarks on the sphere, and files of them. */
#ifndef STARG_MORPH_LANDMARKS_H
#define STARG_MORPH_LANDMARKS_H

#include "morph/align.h"

/* Moves the directions of `from` until each landmark lies exactly where its counterpart is on `to`,
 * every triangle positive all the way. Errors: MESH (they cannot be met: contradicting), MEMORY,
 * CANCELLED. */
starg_status landmarks_meet(sphere *from, const sphere *to, const landmark_list *landmarks);

#endif
