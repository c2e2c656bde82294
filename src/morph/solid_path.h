/* SPDX-License-Identifier: Apache-2.0 */
/* Morphs of solids. */
#pragma once

#include "morph/deform.h"

/* Tetrahedra at both ends, and their way. */
typedef struct solid_path {
    deform_mesh mesh;
    uint32_t *surface; /* the morph's numbers of the first vertices */
    deform_path keys;
    uint32_t *labels; /* of cones of star-shaped ends: all 0; else NULL */
} solid_path;

void solid_path_free(solid_path *path);
