/* SPDX-License-Identifier: Apache-2.0 */
/* Extra data for a picture of a mesh: corner normals and feature lines. Decoration only: any mesh
 * is accepted. */
#pragma once

#include "core/memory.h"

typedef STARG_ARRAY(uint32_t) starg_index_array;

typedef struct starg_features {
    float *normals;          /* face_count x 3 corners x 3, unit length */
    starg_index_array lines; /* pairs of vertex indices */
} starg_features;

/* Finds both for `vertices`, of any orthonormal frame. Errors: MEMORY. */
starg_status starg_features_create(starg_context *context, const double *vertices,
                                   size_t vertex_count, const uint32_t *faces, size_t face_count,
                                   starg_features *out);
void starg_features_free(starg_features *features);
