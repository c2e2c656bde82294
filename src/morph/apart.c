/* SPDX-License-Identifier: Apache-2.0 */
/* How far two surfaces are apart: the largest distance of a vertex of either from the other.
 *
 * Between the vertices a surface may be farther away, by no more than its edges are long there.
 * Cost: O(log n) for each vertex, by trees. */
#include <math.h>

#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "starguard/morph.h"

static starg_status go_from(starg_context *context, const starg_mesh *from, const starg_mesh *to,
                            double *largest) {
    SCOPED_BY(bvh_drop) bvh *tree = NULL;
    TRY(bvh_create(context, to->vertices, to->faces, to->face_count, &tree));
    for (size_t h = 0; h < 3 * from->face_count; h++) {
        *largest = fmax(*largest, bvh_distance(tree, from->vertices + 3 * (size_t)from->faces[h]));
        if (h % 4096 == 0)
            TRY(starg_check_cancel(context, "distance"));
    }
    return STARG_OK;
}

starg_status starg_mesh_apart(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                              double *largest) {
    *largest = 0;
    TRY(go_from(context, a, b, largest));
    return go_from(context, b, a, largest);
}
