/* SPDX-License-Identifier: Apache-2.0 */
/* Which faces bound each piece: those without a neighbour of the same label, filed by label
 * (counting sort). Cost: O(n). */
#include "star/piece_faces.h"

#include "core/memory.h"

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
        piece_faces_free(context, out);
    return status;
}

void piece_faces_free(starg_context *context, piece_faces *faces) {
    starg_release(context, faces->first);
    starg_release(context, faces->corners);
    *faces = (piece_faces){0};
}

starg_status piece_faces_add(starg_context *context, const starg_tetmesh *mesh,
                             const uint32_t *labels, size_t face, uint32_t piece, uint32_t other,
                             face_corners *out) {
    starg_status status = STARG_OK;
    uint32_t corners[3], across = mesh->neighbours[face];
    if (across != STARG_TETMESH_NONE && (labels[across] == piece || labels[across] == other))
        return STARG_OK;
    piece_face_corners(mesh, face, corners);
    for (int k = 0; k < 3; k++)
        STARG_PUSH(context, STAGE, out, corners[k]);
done:
    return status;
}
