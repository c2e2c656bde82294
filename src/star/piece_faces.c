/* SPDX-License-Identifier: Apache-2.0 */
/* Which faces bound each piece: those without a neighbour of the same label, filed by label
 * (counting sort). Cost: O(n). */
#include "star/piece_faces.h"

#include "geometry/intersect.h"

static const char STAGE[] = "pieces";

static bool is_boundary(const starg_tetmesh *mesh, const int32_t *labels, size_t face) {
    uint32_t neighbour = mesh->neighbours[face];
    return neighbour == STARG_TETMESH_NONE || labels[neighbour] != labels[face / 4];
}

/* Afterwards first[p + 1] is the number of faces of piece p. */
static void count_faces(const starg_tetmesh *mesh, const int32_t *labels, size_t *first) {
    for (size_t f = 0; f < 4 * mesh->count; f++)
        if (is_boundary(mesh, labels, f))
            first[(size_t)labels[f / 4] + 1]++;
}

/* Fills the slots of each piece in turn; `next` says which is the first that is free. */
static void file_faces(const starg_tetmesh *mesh, const int32_t *labels, size_t *next,
                       uint32_t *corners) {
    for (size_t f = 0; f < 4 * mesh->count; f++)
        if (is_boundary(mesh, labels, f))
            piece_face_corners(mesh, f, corners + 3 * next[labels[f / 4]]++);
}

starg_status piece_faces_create(starg_context *context, const starg_tetmesh *mesh,
                                const int32_t *labels, size_t piece_count, piece_faces *out) {
    starg_status status = STARG_OK;
    size_t *next = NULL;
    *out = (piece_faces){.vertices = mesh->vertices, .piece_count = piece_count};
    STARG_NEW_ZERO(context, STAGE, out->first, piece_count + 1);
    STARG_NEW(context, STAGE, next, piece_count + 1);
    count_faces(mesh, labels, out->first);
    for (size_t p = 0; p < piece_count; p++)
        out->first[p + 1] += out->first[p];
    memcpy(next, out->first, (piece_count + 1) * sizeof *next);
    STARG_NEW(context, STAGE, out->corners, 3 * out->first[piece_count]);
    file_faces(mesh, labels, next, out->corners);
done:
    starg_release(context, next);
    if (status != STARG_OK)
        piece_faces_free(out);
    return status;
}

void piece_faces_free(piece_faces *faces) {
    RELEASE(faces->first, faces->corners);
    *faces = (piece_faces){0};
}

starg_status piece_faces_add(starg_context *context, const starg_tetmesh *mesh,
                             const uint32_t *labels, size_t face, uint32_t piece, uint32_t other,
                             face_corners *out) {
    uint32_t corners[3], across = mesh->neighbours[face];
    if (across != STARG_TETMESH_NONE && (labels[across] == piece || labels[across] == other))
        return STARG_OK;
    piece_face_corners(mesh, face, corners);
    for (int k = 0; k < 3; k++)
        PUSH(context, STAGE, out, corners[k]);
    return STARG_OK;
}

/* Does a point inside of a tetrahedral mesh see another one? By a tree over the boundary faces,
 * exactly [YL11, section 4: the visibility of section 3.1 for all vertices of tetrahedra]. Cost:
 * O(log n) a segment where little stands between. */

static const char STAGE_SIGHT[] = "sight";

starg_status tet_sight_create(starg_context *context, const starg_tetmesh *mesh, tet_sight *out) {
    size_t count = 0;
    *out = (tet_sight){0};
    for (size_t f = 0; f < 4 * mesh->count; f++)
        count += mesh->neighbours[f] == STARG_TETMESH_NONE;
    NEW(context, STAGE_SIGHT, out->faces, 3 * count);
    count = 0;
    for (size_t f = 0; f < 4 * mesh->count; f++)
        if (mesh->neighbours[f] == STARG_TETMESH_NONE)
            piece_face_corners(mesh, f, out->faces + 3 * count++);
    return bvh_create(context, mesh->vertices, out->faces, count, &out->tree);
}

void tet_sight_free(tet_sight *sight) {
    bvh_free(sight->tree);
    RELEASE(sight->faces);
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
