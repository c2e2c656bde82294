/* SPDX-License-Identifier: Apache-2.0 */
/* Extremities, the ends of a shape's limbs: features for orientation. */
#pragma once

#include "sphere/sphere.h"

enum { EXTREMITIES_MOST = 16 };

typedef struct extremity_list {
    size_t count;
    uint32_t vertices[EXTREMITIES_MOST];
} extremity_list;

/* Finds the extremities of a surface, most extreme first. Errors: MEMORY, CANCELLED. */
starg_status extremities_find(const sphere *s, extremity_list *out);
