/* SPDX-License-Identifier: Apache-2.0 */
/* Morphs of solids. */
#ifndef STARG_MORPH_SOLID_PATH_H
#define STARG_MORPH_SOLID_PATH_H

#include "morph/deform.h"

/* Tetrahedra at both ends, and their way. */
typedef struct solid_path {
    deform_mesh mesh;
    uint32_t *surface; /* the morph's numbers of the first vertices */
    deform_path keys;
} solid_path;

void solid_path_free(starg_context *context, solid_path *path);

#endif
