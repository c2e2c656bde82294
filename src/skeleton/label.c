/* SPDX-License-Identifier: Apache-2.0 */
/* Labels tetrahedra by the surface: a tetrahedron at a face of the samples lies on the side given
 * by an exact predicate, and labels spread to neighbours across all other faces, widest first. This
 * uses only adjacency and is exact, however flat tetrahedra are, as long as no face is lost. Where
 * faces are lost, an inside and an outside that meet are kept apart.
 *
 * Cost: O(n log n). */
#include "skeleton/skeleton.h"

#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

static const char STAGE[] = "skeleton labels";

enum { UNKNOWN = 0, INSIDE = 1, OUTSIDE = -1, BLOCK = 256 };
static const uint32_t NOTHING = UINT32_MAX;

/* A face of the samples, by its other two corners. */
typedef struct face_key {
    uint32_t middle, highest, face;
} face_key;

typedef struct labelling {
    starg_context *context;
    const starg_solid *solid;
    const surface_samples *samples;
    const delaunay *tetrahedra;
    inside_labels *labels;
    uint32_t *first_face; /* faces whose lowest corner is v: keys[first_face[v] ..] */
    face_key *keys;
    int8_t *side;
    uint8_t *walls; /* bit k: the face opposite corner k is a face of the samples */
} labelling;

static void sort_corners(uint32_t v[3]) {
    uint32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
    v[1] = v[2] < low ? low : v[2] > high ? high : v[2];
    v[0] = v[2] < low ? v[2] : low;
    v[2] = v[2] > high ? v[2] : high;
}

/* The last of the faces with these corners, or NOTHING. */
static uint32_t find_face(const labelling *l, const uint32_t sorted[3]) {
    for (uint32_t i = l->first_face[sorted[0] + 1]; i-- > l->first_face[sorted[0]];)
        if (l->keys[i].middle == sorted[1] && l->keys[i].highest == sorted[2])
            return l->keys[i].face;
    return NOTHING;
}

/* Lists the faces at their lowest corners, by counting sort. */
static starg_status enter_faces(labelling *l) {
    const surface_samples *samples = l->samples;
    NEW_ZERO(l->context, STAGE, l->first_face, samples->point_count + 2);
    NEW(l->context, STAGE, l->keys, samples->face_count);
    uint32_t *end = l->first_face + 1; /* of each list as it fills */
    for (size_t f = 0; f < samples->face_count; f++) {
        uint32_t v[3];
        memcpy(v, samples->faces + 3 * f, sizeof v);
        sort_corners(v);
        end[v[0] + 1]++;
    }
    for (size_t v = 0; v < samples->point_count; v++)
        end[v + 1] += end[v];
    for (size_t f = 0; f < samples->face_count; f++) {
        uint32_t v[3];
        memcpy(v, samples->faces + 3 * f, sizeof v);
        sort_corners(v);
        l->keys[end[v[0]]++] = (face_key){v[1], v[2], (uint32_t)f};
    }
    return STARG_OK;
}

static const double *sample(const labelling *l, uint32_t index) {
    return l->samples->points + 3 * (size_t)index;
}

/* Labels tetrahedron t if its face opposite corner k is one of the samples'. */
static void match_face(labelling *l, size_t t, int k) {
    const uint32_t *corners = l->tetrahedra->tetrahedra[t];
    uint32_t v[3] = {0};
    for (int j = 0, n = 0; j < 4; j++)
        if (j != k)
            v[n++] = corners[j];
    sort_corners(v);
    uint32_t face = find_face(l, v);
    if (face == NOTHING)
        return;
    const uint32_t *f = l->samples->faces + 3 * (size_t)face;
    l->labels->found[face] = true;
    l->walls[t] |= (uint8_t)(1 << k);
    l->side[t] =
        orient3d(sample(l, f[0]), sample(l, f[1]), sample(l, f[2]), sample(l, corners[k])) > 0
            ? INSIDE
            : OUTSIDE;
}

static void match_faces(labelling *l) {
    for (size_t t = 0; t < l->tetrahedra->count; t++)
        for (int k = 0; k < 4; k++)
            match_face(l, t, k);
    l->labels->lost_count = 0;
    for (size_t f = 0; f < l->samples->face_count; f++)
        l->labels->lost_count += !l->labels->found[f];
}

/* A triangle between two tetrahedra that is not a wall. */
typedef struct passage {
    double width; /* squared circumradius of the triangle */
    uint32_t t, side;
} passage;

static int compare_passages(const void *left, const void *right) {
    const passage *a = left, *b = right;
    if (a->width != b->width)
        return a->width > b->width ? -1 : 1;
    if (a->t != b->t)
        return a->t < b->t ? -1 : 1;
    return (a->side > b->side) - (a->side < b->side);
}

static double width_of(const labelling *l, uint32_t t, uint32_t side) {
    const double *v[3];
    const uint32_t *corners = l->tetrahedra->tetrahedra[t];
    for (uint32_t j = 0, n = 0; j < 4; j++)
        if (j != side)
            v[n++] = sample(l, corners[j]);
    double area = vec3_triangle_area(v[0], v[1], v[2]);
    double product = vec3_distance_squared(v[0], v[1]) * vec3_distance_squared(v[1], v[2]) *
                     vec3_distance_squared(v[2], v[0]);
    double width = product / (16 * area * area);
    return isfinite(width) ? width : 0;
}

/* Without gaps in the walls the order does not matter: the two sides of an embedded surface never
 * meet. */
static bool is_tight(const labelling *l) {
    return l->labels->lost_count == 0 && l->solid->check->embedded;
}

static starg_status find_passages(const labelling *l, passage **passages, size_t *count) {
    bool ordered = !is_tight(l);
    NEW(l->context, STAGE, *passages, 2 * l->tetrahedra->count);
    for (uint32_t t = 0; t < l->tetrahedra->count; t++)
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t other = l->tetrahedra->neighbours[t][k];
            if (!(l->walls[t] >> k & 1) && other != DELAUNAY_NONE && t < other)
                (*passages)[(*count)++] = (passage){ordered ? width_of(l, t, k) : 0, t, k};
        }
    if (ordered)
        qsort(*passages, *count, sizeof **passages, compare_passages);
    return STARG_OK;
}

/* Joins tetrahedra through passages, widest first, but never an inside to an outside: at gaps the
 * two sides meet in the narrowest triangles. */
static starg_status spread(labelling *l) {
    SCOPED uint32_t *sets = NULL;
    SCOPED passage *passages = NULL;
    size_t count = 0;
    NEW(l->context, STAGE, sets, l->tetrahedra->count);
    sets_make(sets, l->tetrahedra->count);
    TRY(find_passages(l, &passages, &count));
    for (size_t i = 0; i < count; i++) {
        uint32_t a = sets_find(sets, passages[i].t);
        uint32_t b = sets_find(sets, l->tetrahedra->neighbours[passages[i].t][passages[i].side]);
        if (a == b || l->side[a] * l->side[b] < 0)
            continue;
        int8_t side = l->side[a] != UNKNOWN ? l->side[a] : l->side[b];
        sets_join(sets, a, b);
        l->side[sets_find(sets, a)] = side;
    }
    for (uint32_t t = 0; t < l->tetrahedra->count; t++)
        l->side[t] = l->side[sets_find(sets, t)];
    return STARG_OK;
}

starg_status labels_create(starg_context *context, const starg_solid *solid,
                           const surface_samples *samples, const delaunay *tetrahedra,
                           inside_labels *labels) {
    starg_status status = STARG_OK;
    labelling l = {.context = context,
                   .solid = solid,
                   .samples = samples,
                   .tetrahedra = tetrahedra,
                   .labels = labels};
    *labels = (inside_labels){0};
    STARG_NEW(context, STAGE, labels->inside, tetrahedra->count);
    STARG_NEW_ZERO(context, STAGE, labels->found, samples->face_count);
    STARG_NEW_ZERO(context, STAGE, l.side, tetrahedra->count);
    STARG_NEW_ZERO(context, STAGE, l.walls, tetrahedra->count);
    STARG_TRY(enter_faces(&l));
    match_faces(&l);
    STARG_TRY(spread(&l));
    for (size_t t = 0; t < tetrahedra->count; t++)
        labels->inside[t] = l.side[t] == INSIDE;
done:
    RELEASE(l.first_face, l.keys, l.side, l.walls);
    if (status != STARG_OK)
        labels_free(labels);
    return status;
}

void labels_free(inside_labels *labels) {
    RELEASE(labels->inside, labels->found);
    *labels = (inside_labels){0};
}
