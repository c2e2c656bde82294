/* SPDX-License-Identifier: Apache-2.0 */
/* How must one spread surface be turned so that it lies on another one as well as possible? */
#ifndef STARG_MORPH_ALIGN_H
#define STARG_MORPH_ALIGN_H

#include "morph/extremities.h"
#include "morph/locate.h"

/* Corresponding vertices: `from` of the first surface, `to` of the second. */
typedef struct landmark_list {
    const uint32_t *from, *to;
    size_t count;
} landmark_list;

/* Extremities that seem to correspond. */
typedef struct feature_pairs {
    size_t count;
    uint32_t from[EXTREMITIES_MOST], to[EXTREMITIES_MOST];
} feature_pairs;

/* Turns the directions of `from`. Where no landmarks are given, `features` tells the extremities of
 * both surfaces that are near to one another in space. Errors: MEMORY, CANCELLED. */
starg_status align_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                           feature_pairs *features);

#endif
