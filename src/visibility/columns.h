/* SPDX-License-Identifier: Apache-2.0 */
/* The columns of visibility rows. */
#ifndef STARG_VISIBILITY_COLUMNS_H
#define STARG_VISIBILITY_COLUMNS_H

#include "mesh/mesh.h"
#include "starguard/visibility.h"

static inline size_t target_columns(const starg_mesh *mesh, starg_target target) {
    return target == STARG_TARGET_VERTICES  ? mesh->vertex_count
           : target == STARG_TARGET_CORNERS ? 3 * mesh->face_count
                                            : mesh->face_count;
}

#endif
