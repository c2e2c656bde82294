/* SPDX-License-Identifier: Apache-2.0 */
/* Colours and texture coordinates of A on the overlay of A and B, linear on each face of A.
 *
 * Colours belong to vertices, which have a place on A each. Texture coordinates belong to corners,
 * and on an edge of A its two faces may have different ones: the face of A that holds a face of the
 * overlay is the one with all vertices of A that have a share in its corners. Cost: O(n log n). */
#include <stdlib.h>

#include "mesh/mesh.h"
#include "starguard/morph.h"

static const char STAGE[] = "overlay";

/* A face of A by its vertices in ascending order. */
typedef struct key {
    uint32_t vertices[3], face;
} key;

static void insert(uint32_t vertex, uint32_t *set, size_t *count) {
    size_t at = *count;
    for (size_t i = 0; i < *count; i++)
        if (set[i] == vertex)
            return;
    for (; at > 0 && set[at - 1] > vertex; at--)
        set[at] = set[at - 1];
    set[at] = vertex;
    *count += 1;
}

static int compare_keys(const void *left, const void *right) {
    const key *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->vertices[k] != b->vertices[k])
            return a->vertices[k] < b->vertices[k] ? -1 : 1;
    return 0;
}

static starg_status list_faces(starg_context *context, const starg_mesh *a, key **out) {
    NEW(context, STAGE, *out, a->face_count);
    for (size_t f = 0; f < a->face_count; f++) {
        size_t count = 0;
        (*out)[f] = (key){.face = (uint32_t)f};
        for (size_t k = 0; k < 3; k++)
            insert(a->faces[3 * f + k], (*out)[f].vertices, &count);
    }
    qsort(*out, a->face_count, sizeof **out, compare_keys);
    return STARG_OK;
}

/* The face of A that holds a face of the overlay; the first corner's, if that has no area there. */
static size_t holder_of(const starg_overlay *overlay, const starg_mesh *a, const key *keys,
                        size_t face) {
    uint32_t set[9];
    size_t count = 0;
    for (size_t i = 0; i < 9; i++) {
        const size_t v = overlay->faces[3 * face + i / 3];
        if (overlay->own_coordinates[3 * v + i % 3] != 0)
            insert(a->faces[3 * (size_t)overlay->own_faces[v] + i % 3], set, &count);
    }
    const key wanted = {.vertices = {set[0], set[1], set[2]}};
    const key *found =
        count == 3 ? bsearch(&wanted, keys, a->face_count, sizeof *keys, compare_keys) : NULL;
    return found != NULL ? found->face : overlay->own_faces[overlay->faces[3 * face]];
}

/* The share of A's vertex in the place of an overlay's vertex. */
static double share_of(const starg_overlay *overlay, const starg_mesh *a, size_t vertex,
                       uint32_t own) {
    const size_t face = overlay->own_faces[vertex];
    for (size_t k = 0; k < 3; k++)
        if (a->faces[3 * face + k] == own)
            return overlay->own_coordinates[3 * vertex + k];
    return 0;
}

static starg_status carry_texture(starg_context *context, const starg_overlay *overlay,
                                  const starg_mesh *a, starg_mesh *refined) {
    SCOPED key *keys = NULL;
    SCOPED float *texture = NULL;
    TRY(list_faces(context, a, &keys));
    NEW_ZERO(context, STAGE, texture, 6 * overlay->face_count);
    for (size_t i = 0; i < 3 * overlay->face_count; i++) {
        const size_t face = holder_of(overlay, a, keys, i / 3);
        double uv[2] = {0, 0};
        for (size_t k = 0; k < 3; k++) {
            double share = share_of(overlay, a, overlay->faces[i], a->faces[3 * face + k]);
            uv[0] += share * (double)a->texture[6 * face + 2 * k];
            uv[1] += share * (double)a->texture[6 * face + 2 * k + 1];
        }
        texture[2 * i] = (float)uv[0];
        texture[2 * i + 1] = (float)uv[1];
    }
    return starg_mesh_set_texture(refined, texture);
}

static starg_status carry_colors(starg_context *context, const starg_overlay *overlay,
                                 const starg_mesh *a, starg_mesh *refined) {
    SCOPED uint8_t *colors = NULL;
    NEW(context, STAGE, colors, 3 * overlay->vertex_count);
    for (size_t v = 0; v < overlay->vertex_count; v++)
        for (size_t part = 0; part < 3; part++) {
            double sum = 0.5; /* rounded */
            for (size_t k = 0; k < 3; k++) {
                size_t own = a->faces[3 * (size_t)overlay->own_faces[v] + k];
                sum += overlay->own_coordinates[3 * v + k] * a->colors[3 * own + part];
            }
            colors[3 * v + part] = (uint8_t)sum;
        }
    return starg_mesh_set_colors(refined, colors);
}

starg_status starg_overlay_look(starg_context *context, const starg_overlay *overlay,
                                const starg_mesh *a, starg_mesh *refined) {
    if (refined->vertex_count != overlay->vertex_count ||
        refined->face_count != overlay->face_count)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the mesh has %zu vertices and %zu faces, the overlay %zu and %zu",
                          refined->vertex_count, refined->face_count, overlay->vertex_count,
                          overlay->face_count);
    if (a->colors != NULL)
        TRY(carry_colors(context, overlay, a, refined));
    return a->texture != NULL ? carry_texture(context, overlay, a, refined) : STARG_OK;
}
