/* SPDX-License-Identifier: Apache-2.0 */
/* Checks that a surface is embedded: its faces have area and meet only in shared corners and edges,
 * and the faces at each vertex form one fan.
 *
 * Two triangles have a common point exactly if an edge of one meets the other. If they share one
 * corner, any other common point lies on a common segment from that corner, which extends to the
 * opposite edge of one of them; if they share an edge, they have more in common only if coplanar
 * and on the same side of the edge. All by exact signs. Cost: O(n log n) for ordinary surfaces. */
#include "core/memory.h"
#include "core/parallel.h"
#include "verify/hidden.h"
#include "verify/signs.h"

static const char STAGE[] = "verify";

static bool segment_meets(const double p[3], const double q[3], const double *const t[3]) {
    return verify_on_triangle(p, t) || verify_on_triangle(q, t) || verify_blocks(p, q, t);
}

/* An axis along which the triangle's projection has area, or -1. */
static int broad_axis(const double *const t[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (verify_turn(t[0], t[1], t[2], axis) != 0)
            return axis;
    return -1;
}

/* Number of corners of s shared with t: *own and *other are the opposite corners if two are shared,
 * or the shared ones if one is. */
static int shared_corners(const uint32_t *s, const uint32_t *t, int *own, int *other) {
    int count = 0, own_sum = 0, other_sum = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (s[i] == t[j]) {
                count++;
                own_sum += i;
                other_sum += j;
            }
    *own = count == 2 ? 3 - own_sum : own_sum;
    *other = count == 2 ? 3 - other_sum : other_sum;
    return count;
}

static bool is_contact(const verify_surface *surface, uint32_t f, uint32_t g) {
    const double *s[3], *t[3];
    int own, other;
    int shared = shared_corners(surface->faces + 3 * (size_t)f, surface->faces + 3 * (size_t)g,
                                &own, &other);
    verify_corners(surface, f, s);
    verify_corners(surface, g, t);
    if (shared == 1)
        return segment_meets(s[(own + 1) % 3], s[(own + 2) % 3], t) ||
               segment_meets(t[(other + 1) % 3], t[(other + 2) % 3], s);
    if (shared == 2) {
        int axis = broad_axis(s);
        const double *a = s[(own + 1) % 3], *b = s[(own + 2) % 3];
        return verify_side(s[0], s[1], s[2], t[other]) == 0 &&
               verify_turn(a, b, s[own], axis) * verify_turn(a, b, t[other], axis) >= 0;
    }
    for (int i = 0; shared == 0 && i < 3; i++)
        if (segment_meets(s[i], s[(i + 1) % 3], t) || segment_meets(t[i], t[(i + 1) % 3], s))
            return true;
    return shared == 3;
}

typedef struct search {
    const verify_scene *scene;
    uint8_t *clear; /* by face */
} search;

typedef struct one_face {
    const verify_surface *surface;
    uint32_t face;
} one_face;

static bool is_clear_of(void *data, uint32_t other) {
    const one_face *own = data;
    return other <= own->face || !is_contact(own->surface, own->face, other);
}

static starg_status examine_face(starg_context *context, void *shared, void *scratch, size_t f) {
    const search *own = shared;
    const double *t[3];
    double lower[3], upper[3];
    one_face one = {own->scene->surface, (uint32_t)f};
    (void)context;
    (void)scratch;
    verify_corners(one.surface, f, t);
    for (int k = 0; k < 3; k++) {
        lower[k] = upper[k] = t[0][k];
        for (int i = 1; i < 3; i++) {
            lower[k] = t[i][k] < lower[k] ? t[i][k] : lower[k];
            upper[k] = t[i][k] > upper[k] ? t[i][k] : upper[k];
        }
    }
    own->clear[f] =
        broad_axis(t) >= 0 && verify_tree_visit(own->scene->tree, lower, upper, is_clear_of, &one);
    return STARG_OK;
}

/* Do the faces at each vertex form one fan? Walks around from one edge must reach all. */
static bool has_single_fans(const verify_scene *scene, uint32_t *count) {
    const verify_surface *surface = scene->surface;
    for (size_t e = 0; e < 3 * surface->face_count; e++)
        count[surface->faces[e]]++;
    for (size_t v = 0; v < surface->vertex_count; v++) {
        uint32_t first = scene->outgoing[v], e = first, passed = 0;
        if (first == UINT32_MAX)
            continue;
        do {
            passed++;
            e = scene->twin[e % 3 == 0 ? e + 2 : e - 1];
        } while (e != first);
        if (passed != count[v])
            return false;
    }
    return true;
}

starg_status verify_find_embedded(const verify_scene *scene, bool *embedded) {
    starg_status status = STARG_OK;
    starg_context *context = scene->surface->context;
    search own = {.scene = scene};
    uint32_t *count = NULL;
    size_t faces = scene->surface->face_count;
    STARG_NEW_ZERO(context, STAGE, own.clear, faces);
    STARG_NEW_ZERO(context, STAGE, count, scene->surface->vertex_count);
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = faces, .shared = &own, .item = examine_face, .silent = true};
    STARG_TRY(starg_parallel_for(context, &loop));
    *embedded = has_single_fans(scene, count);
    for (size_t f = 0; f < faces; f++)
        *embedded = *embedded && own.clear[f];
done:
    starg_release(context, own.clear);
    starg_release(context, count);
    return status;
}
