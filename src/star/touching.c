/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces that touch themselves.
 *
 * Problem: parts of a solid may meet in edges and vertices, each with vertices of its own at the
 * same positions. Cuts of pieces can go across such edges if they are edges of all their faces.
 *
 * Method: vertices at equal positions become one; then every pair of faces must meet in what they
 * share. No face then meets another inside, so that the winding number is the same everywhere just
 * behind it. Exact. Cost: that of finding the pairs again, where the check has found contacts. */
#include "star/decomposition.h"

#include "mesh/examine.h"

static const char STAGE[] = "pieces";

typedef struct welded {
    const double *vertices;
    const uint32_t *faces;
} welded;

static bool meet_well(void *user, uint32_t a, uint32_t b) {
    const welded *w = user;
    triangle_contact contact =
        faces_contact(w->vertices, w->faces + 3 * (size_t)a, w->faces + 3 * (size_t)b);
    return contact == TRIANGLES_APART || contact == TRIANGLES_SHARE;
}

starg_status touching_weld(starg_context *context, const starg_solid *solid, uint32_t **faces) {
    const starg_mesh *mesh = solid->mesh;
    const starg_finding *found = solid->check->findings;
    SCOPED uint32_t *first = NULL;
    size_t count = 3 * mesh->face_count, moved;
    *faces = NULL;
    if (found[STARG_FINDING_SELF_INTERSECTION].count > 0 ||
        found[STARG_FINDING_DEGENERATE_FACE].count > 0)
        return STARG_OK;
    TRY(mesh_find_coincident(context, mesh, &first, &moved));
    NEW(context, STAGE, *faces, count);
    for (size_t i = 0; i < count; i++)
        (*faces)[i] = first[mesh->faces[i]];
    welded w = {mesh->vertices, *faces};
    if (found[STARG_FINDING_SELF_CONTACT].count == 0 || bvh_query_pairs(solid->tree, meet_well, &w))
        return STARG_OK;
    starg_release(context, *faces);
    *faces = NULL;
    return STARG_OK;
}

starg_status touching_bounds(starg_context *context, const starg_solid *solid, bool *bounds) {
    uint32_t *faces = NULL;
    starg_status status = STARG_OK;
    *bounds = solid->check->embedded;
    if (*bounds)
        return STARG_OK;
    status = touching_weld(context, solid, &faces);
    *bounds = faces != NULL;
    for (uint32_t f = 0; f < solid->mesh->face_count && *bounds; f++)
        *bounds = bvh_winding_behind(solid->tree, f, 0) == 1;
    starg_release(context, faces);
    return status;
}
