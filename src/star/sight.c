/* SPDX-License-Identifier: Apache-2.0 */
/* Does a point inside of a tetrahedral mesh see another one? By a tree over the boundary faces,
 * exactly [YL11, section 4: the visibility of section 3.1 for all vertices of tetrahedra]. Cost:
 * O(log n) a segment where little stands between. */
#include "star/sight.h"

#include "core/memory.h"
#include "geometry/intersect.h"
#include "star/piece_faces.h"

static const char STAGE[] = "sight";

starg_status tet_sight_create(starg_context *context, const starg_tetmesh *mesh, tet_sight *out) {
    starg_status status = STARG_OK;
    size_t count = 0;
    *out = (tet_sight){0};
    for (size_t f = 0; f < 4 * mesh->count; f++)
        count += mesh->neighbours[f] == STARG_TETMESH_NONE;
    STARG_NEW(context, STAGE, out->faces, 3 * count);
    count = 0;
    for (size_t f = 0; f < 4 * mesh->count; f++)
        if (mesh->neighbours[f] == STARG_TETMESH_NONE)
            piece_face_corners(mesh, f, out->faces + 3 * count++);
    STARG_TRY(bvh_create(context, mesh->vertices, out->faces, count, &out->tree));
done:
    if (status != STARG_OK)
        tet_sight_free(context, out);
    return status;
}

void tet_sight_free(starg_context *context, tet_sight *sight) {
    bvh_free(sight->tree);
    starg_release(context, sight->faces);
    *sight = (tet_sight){0};
}

bool tet_sight_contains(const tet_sight *sight, const double p[3]) {
    bool on_surface;
    int winding = bvh_winding(sight->tree, p, &on_surface);
    return winding > 0 && !on_surface;
}

typedef struct sight_query {
    const bvh *tree;
    const double *p, *q;
} sight_query;

static bool passes(void *user, size_t rank) {
    const sight_query *query = user;
    const uint32_t *face = query->tree->faces + 3 * (size_t)query->tree->order[rank];
    const double *v = query->tree->vertices;
    return !segment_meets_triangle(query->p, query->q, v + 3 * (size_t)face[0],
                                   v + 3 * (size_t)face[1], v + 3 * (size_t)face[2]);
}

bool tet_sight_is_free(const tet_sight *sight, const double p[3], const double q[3]) {
    sight_query query = {sight->tree, p, q};
    return bvh_query_segment(sight->tree, p, q, passes, &query);
}
