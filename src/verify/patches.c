/* SPDX-License-Identifier: Apache-2.0 */
/* The parts that faces are seen in, found anew by the rule of docs/visibility.md: a face, and each
 * half of it, is halved from the midpoint of its longest edge to the opposite corner until no edge
 * is longer than asked for.
 *
 * Corners have weights by the vertices of the face, multiples of 1 / VERIFY_UNIT; an edge whose
 * midpoint would need finer ones is not halved. Both halves share the midpoint, while a part across
 * the halved edge has its own one: there are as many points as halvings. Their coordinates are
 * rounded in the order of the page, so that both sides of an edge have the same. Cost: that of the
 * parts. */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "verify/sight.h"

static const char STAGE[] = "verify";

enum { MOST_PATCHES = 10000000, CANCEL_STEP = 4096 };

/* ---- halving ---- */

verify_part verify_part_of(const verify_surface *surface, uint32_t face) {
    verify_part whole = {.face = face, .share = 1};
    for (int i = 0; i < 3; i++) {
        whole.index[i] = surface->faces[3 * (size_t)face + (size_t)i];
        whole.weight[i][i] = (uint32_t)VERIFY_UNIT;
    }
    return whole;
}

double verify_edge_square(const verify_surface *surface, const verify_part *part, int k) {
    const uint32_t *from = part->weight[k], *to = part->weight[(k + 1) % 3];
    double first = ((double)to[1] - (double)from[1]) / VERIFY_UNIT;
    double second = ((double)to[2] - (double)from[2]) / VERIFY_UNIT;
    const double *t[3];
    double square = 0;
    verify_corners(surface, part->face, t);
    for (int i = 0; i < 3; i++) {
        double along = first * (t[1][i] - t[0][i]) + second * (t[2][i] - t[0][i]);
        square += along * along;
    }
    return square;
}

/* The corners of a face in the order of the vertices' numbers. */
static void order_corners(const uint32_t *face, int order[3]) {
    for (int i = 0; i < 3; i++) {
        int rank = 0;
        for (int j = 0; j < 3; j++)
            rank += face[j] < face[i] || (face[j] == face[i] && j < i);
        order[rank] = i;
    }
}

verify_mix verify_mix_of(const verify_surface *surface, uint32_t face, const uint32_t weight[3]) {
    const uint32_t *vertex = surface->faces + 3 * (size_t)face;
    int order[3];
    const double *t[3];
    verify_mix mix;
    order_corners(vertex, order);
    verify_corners(surface, face, t);
    for (int i = 0; i < 3; i++) {
        mix.vertex[i] = vertex[order[i]];
        mix.weight[i] = weight[order[i]];
    }
    for (int k = 0; k < 3; k++) {
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += mix.weight[i] * t[order[i]][k];
        mix.at[k] = sum / VERIFY_UNIT;
    }
    return mix;
}

static starg_status add_point(verify_parts *own, const verify_part *part, int corner) {
    const verify_mix mix = verify_mix_of(own->surface, part->face, part->weight[corner]);
    PUSH(own->surface->context, STAGE, &own->mixes, mix);
    return STARG_OK;
}

starg_status verify_halve(verify_parts *own, const verify_part *part, int k, verify_part half[2],
                          bool *halved) {
    int next = (k + 1) % 3;
    half[0] = half[1] = *part;
    *halved = true;
    for (int i = 0; i < 3; i++) {
        uint32_t sum = part->weight[k][i] + part->weight[next][i];
        *halved = *halved && sum % 2 == 0;
        half[0].weight[next][i] = half[1].weight[k][i] = sum / 2;
    }
    if (!*halved)
        return STARG_OK;
    half[0].share = half[1].share = part->share / 2;
    half[0].index[next] = half[1].index[k] =
        (uint32_t)(own->surface->vertex_count + own->mixes.count);
    return add_point(own, &half[0], next);
}

starg_status verify_parts_add(verify_parts *own, const verify_part *part) {
    starg_context *context = own->surface->context;
    if (own->list.count >= MOST_PATCHES)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "faces would be seen in more than %d parts", (int)MOST_PATCHES);
    if (own->list.count % CANCEL_STEP == 0)
        TRY(starg_check_cancel(context, STAGE));
    PUSH(context, STAGE, &own->list, *part);
    return STARG_OK;
}

void verify_parts_free(verify_parts *own) {
    RELEASE(own->list.data, own->mixes.data);
}

/* ---- down to a length ---- */

static starg_status cut(verify_parts *own, const verify_part *part, double limit) {
    int longest = -1;
    double most = limit;
    bool halved = false;
    verify_part half[2];
    for (int k = 0; k < 3; k++) {
        double square = verify_edge_square(own->surface, part, k);
        if (square > most) {
            most = square;
            longest = k;
        }
    }
    if (longest >= 0)
        TRY(verify_halve(own, part, longest, half, &halved));
    if (!halved)
        return verify_parts_add(own, part);
    TRY(cut(own, &half[0], limit));
    return cut(own, &half[1], limit);
}

starg_status verify_patches_create(verify_surface *surface, double longest) {
    SCOPED_BY(verify_parts_free) verify_parts parts = {.surface = surface};
    for (uint32_t f = 0; f < surface->model_faces; f++) {
        const verify_part whole = verify_part_of(surface, f);
        TRY(cut(&parts, &whole, longest * longest));
    }
    return verify_patches_set(&parts, surface);
}

/* ---- patches ---- */

/* By how much coordinates of points between vertices are off: six roundings, each of no more than
 * 2^-53 of the largest. */
double verify_blur(const verify_surface *surface) {
    double largest = 0;
    for (size_t i = 0; i < 3 * surface->vertex_count; i++)
        largest = fmax(largest, fabs(surface->vertices[i]));
    return 0x1p-50 * largest + 0x1p-1070;
}

/* Is the face the back of another one, its front, that counts from either side? */
static bool front_of(const verify_surface *surface, size_t face, size_t *front) {
    bool back = surface->backs > 0 && face >= surface->backs &&
                face - surface->backs < surface->model_faces;
    *front = back ? face - surface->backs : face;
    return back;
}

/* The patches of a face: the next parts, or those of its front, turned around. */
static void fill(const verify_parts *own, verify_patches *patches, size_t face, size_t *next) {
    size_t front;
    bool back = front_of(own->surface, face, &front);
    patches->first[face] = patches->count;
    size_t i = back ? patches->first[front] : *next;
    for (; i < own->list.count && own->list.data[i].face == front; i++) {
        const verify_part *part = &own->list.data[i];
        uint32_t *corner = patches->corner + 3 * patches->count;
        patches->face[patches->count] = (uint32_t)face;
        patches->share[patches->count++] = part->share;
        for (int k = 0; k < 3; k++)
            corner[back ? (3 - k) % 3 : k] = part->index[k];
    }
    *next = back ? *next : i;
}

starg_status verify_patches_set(const verify_parts *own, verify_surface *surface) {
    starg_context *context = surface->context;
    size_t count = own->list.count * (surface->backs > 0 ? 2 : 1), next = 0;
    SCOPED_BY(verify_patches_drop) verify_patches *patches = NULL;
    NEW_ZERO(context, STAGE, patches, 1);
    NEW(context, STAGE, patches->first, surface->face_count + 1);
    NEW(context, STAGE, patches->face, count);
    NEW(context, STAGE, patches->corner, 3 * count);
    NEW(context, STAGE, patches->share, count);
    NEW(context, STAGE, patches->points, own->mixes.count);
    for (size_t f = 0; f < surface->face_count; f++)
        fill(own, patches, f, &next);
    patches->first[surface->face_count] = patches->count;
    patches->point_count = own->mixes.count;
    for (size_t i = 0; i < own->mixes.count; i++)
        patches->points[i] = own->mixes.data[i];
    patches->blur = verify_blur(surface);
    verify_patches_free(surface->patches);
    surface->patches = patches;
    patches = NULL;
    return STARG_OK;
}

void verify_patches_free(verify_patches *patches) {
    if (patches == NULL)
        return;
    RELEASE(patches->first, patches->face, patches->corner, patches->share, patches->points,
            patches);
}

verify_spot verify_spot_of(const verify_surface *surface, uint32_t index) {
    return index < surface->vertex_count
               ? verify_plain(surface->vertices + 3 * (size_t)index)
               : verify_mix_spot(surface, &surface->patches->points[index - surface->vertex_count],
                                 surface->patches->blur);
}

verify_spot verify_mix_spot(const verify_surface *surface, const verify_mix *mix, double blur) {
    verify_spot spot = {.at = mix->at, .blur = blur};
    for (int i = 0; i < 3; i++) {
        spot.corner[i] = surface->vertices + 3 * (size_t)mix->vertex[i];
        spot.weight[i] = mix->weight[i];
    }
    return spot;
}
