/* SPDX-License-Identifier: Apache-2.0 */
/* Rotates one spherical embedding to match another. */
#pragma once

#include "morph/extremities.h"
#include "morph/locate.h"

/* Corresponding vertices: `from` on the first surface, `to` on the second. */
typedef struct landmark_list {
    const uint32_t *from, *to;
    size_t count;
} landmark_list;

/* Extremities that seem to correspond. */
typedef struct feature_pairs {
    size_t count;
    uint32_t from[EXTREMITIES_MOST], to[EXTREMITIES_MOST];
} feature_pairs;

/* Rotates the directions of `from`. Without landmarks, `features` receives pairs of extremities
 * that are close in space. Errors: MEMORY, CANCELLED. */
starg_status align_spheres(sphere *from, const locator *to, const landmark_list *landmarks,
                           feature_pairs *features);
