/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces of pieces: all faces of the tetrahedra that no other tetrahedron of the same piece
 * shares.
 *
 * Faces are sorted by their corners, so that the two sides of a face are adjacent; pairs of one
 * label are removed. Counting sort orders the rest by pieces. The tetrahedra may be arbitrary as
 * long as indices are in range: unpaired faces are shown. Cost: O(n log n). */
#include "export/export.h"

#include <stdlib.h>

#include "core/memory.h"

static const char STAGE[] = "page";

/* Corners of the face opposite each vertex of a positive tetrahedron, outward. */
static const int OPPOSITE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

enum { MOST = 1 << 29 }; /* tetrahedra: sides are numbered in 32 bits */

/* A face as a side of one tetrahedron. */
typedef struct side {
    uint32_t corners[3]; /* ascending */
    uint32_t place;      /* 4 tetrahedron + opposite vertex; breaks ties */
} side;

static starg_status check(starg_context *context, const starg_pieces_mesh *mesh) {
    if (mesh->count == 0 || mesh->count > MOST)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "pieces of %zu tetrahedra; there must be 1 to 2^29", mesh->count);
    for (size_t t = 0; t < mesh->count; t++) {
        bool good = mesh->labels[t] >= 0 && (size_t)mesh->labels[t] < mesh->count;
        for (size_t k = 0; k < 4; k++)
            good = good && mesh->tetrahedra[4 * t + k] < mesh->vertex_count;
        uint64_t index = t;
        if (!good)
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_TETRAHEDRON,
                                 &index, 1,
                                 "tetrahedron %zu has a vertex or a piece that is out of range", t);
    }
    return STARG_OK;
}

static void put_in_order(uint32_t *a, uint32_t *b) {
    if (*a <= *b)
        return;
    uint32_t held = *a;
    *a = *b;
    *b = held;
}

static side make_side(const starg_pieces_mesh *mesh, size_t place) {
    const uint32_t *t = mesh->tetrahedra + place / 4 * 4;
    const int *k = OPPOSITE[place % 4];
    side s = {.corners = {t[k[0]], t[k[1]], t[k[2]]}, .place = (uint32_t)place};
    put_in_order(&s.corners[0], &s.corners[1]);
    put_in_order(&s.corners[1], &s.corners[2]);
    put_in_order(&s.corners[0], &s.corners[1]);
    return s;
}

static bool same_face(const side *a, const side *b) {
    return memcmp(a->corners, b->corners, sizeof a->corners) == 0;
}

static int compare_sides(const void *left, const void *right) {
    const side *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->corners[k] != b->corners[k])
            return a->corners[k] < b->corners[k] ? -1 : 1;
    return a->place < b->place ? -1 : a->place > b->place;
}

/* Moves the sides that bound a piece to the front; returns their number. */
static size_t keep_boundary(const starg_pieces_mesh *mesh, side *sides, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        bool paired = i + 1 < count && same_face(&sides[i], &sides[i + 1]) &&
                      mesh->labels[sides[i].place / 4] == mesh->labels[sides[i + 1].place / 4];
        if (paired)
            i++;
        else
            sides[kept++] = sides[i];
    }
    return kept;
}

/* Numbers the vertices in use; `numbers` has an entry per vertex of the mesh. */
static void number_vertices(const side *sides, size_t count, size_t vertex_count, uint32_t *numbers,
                            starg_piece_surfaces *out) {
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            numbers[sides[i].corners[k]] = 1;
    for (size_t v = 0; v < vertex_count; v++)
        if (numbers[v] != 0) {
            numbers[v] = (uint32_t)out->vertex_count;
            out->vertices[out->vertex_count++] = (uint32_t)v;
        }
}

/* Faces by piece, within a piece in the order of their sides. */
static void place_faces(const starg_pieces_mesh *mesh, const side *sides, size_t count,
                        const uint32_t *numbers, starg_piece_surfaces *out) {
    size_t *next = out->first_face; /* one ahead during counting and placing */
    for (size_t i = 0; i < count; i++)
        next[mesh->labels[sides[i].place / 4] + 1]++;
    for (size_t p = 0; p < out->piece_count; p++)
        next[p + 1] += next[p];
    for (size_t i = count; i-- > 0;) {
        const uint32_t *t = mesh->tetrahedra + sides[i].place / 4 * 4;
        size_t face = --next[mesh->labels[sides[i].place / 4] + 1];
        for (int k = 0; k < 3; k++)
            out->faces[3 * face + (size_t)k] = numbers[t[OPPOSITE[sides[i].place % 4][k]]];
    }
    for (size_t p = 0; p < out->piece_count; p++)
        next[p] = next[p + 1];
    next[out->piece_count] = count;
}

starg_status starg_piece_surfaces_create(starg_context *context, const starg_pieces_mesh *mesh,
                                         starg_piece_surfaces *out) {
    starg_status status = STARG_OK;
    side *sides = NULL;
    uint32_t *numbers = NULL;
    *out = (starg_piece_surfaces){0};
    STARG_TRY(check(context, mesh));
    for (size_t t = 0; t < mesh->count; t++)
        if ((size_t)mesh->labels[t] >= out->piece_count)
            out->piece_count = (size_t)mesh->labels[t] + 1;
    STARG_NEW(context, STAGE, sides, 4 * mesh->count);
    for (size_t i = 0; i < 4 * mesh->count; i++)
        sides[i] = make_side(mesh, i);
    qsort(sides, 4 * mesh->count, sizeof *sides, compare_sides);
    STARG_TRY(starg_check_cancel(context, STAGE));
    size_t count = keep_boundary(mesh, sides, 4 * mesh->count);

    STARG_NEW_ZERO(context, STAGE, numbers, mesh->vertex_count);
    STARG_NEW(context, STAGE, out->vertices, mesh->vertex_count);
    STARG_NEW(context, STAGE, out->faces, 3 * count);
    STARG_NEW_ZERO(context, STAGE, out->first_face, out->piece_count + 1);
    number_vertices(sides, count, mesh->vertex_count, numbers, out);
    place_faces(mesh, sides, count, numbers, out);
done:
    RELEASE(sides, numbers);
    if (status != STARG_OK)
        starg_piece_surfaces_free(out);
    return status;
}

void starg_piece_surfaces_free(starg_piece_surfaces *surfaces) {
    RELEASE(surfaces->first_face, surfaces->faces, surfaces->vertices);
    *surfaces = (starg_piece_surfaces){0};
}
