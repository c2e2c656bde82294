/* SPDX-License-Identifier: Apache-2.0 */
/* The tetrahedra around each vertex: a counting sort by vertex. Cost: O(n). */
#include "star/paper/state.h"

starg_status tet_rings_create(starg_context *context, const starg_tetmesh *mesh, tet_rings *out) {
    starg_status status = STARG_OK;
    *out = (tet_rings){0};
    STARG_NEW_ZERO(context, PAPER_STAGE, out->first, mesh->vertex_count + 1);
    STARG_NEW(context, PAPER_STAGE, out->at, 4 * mesh->count);
    for (size_t i = 0; i < 4 * mesh->count; i++)
        out->first[mesh->tetrahedra[i]]++;
    for (size_t v = 0, sum = 0; v <= mesh->vertex_count; v++) {
        sum += out->first[v]; /* ends now; beginnings when all are filed */
        out->first[v] = sum;
    }
    for (size_t i = 4 * mesh->count; i-- > 0;)
        out->at[--out->first[mesh->tetrahedra[i]]] = (uint32_t)(i / 4);
done:
    if (status != STARG_OK)
        tet_rings_free(context, out);
    return status;
}

void tet_rings_free(starg_context *context, tet_rings *rings) {
    starg_release(context, rings->first);
    starg_release(context, rings->at);
    *rings = (tet_rings){0};
}
