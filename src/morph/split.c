/* SPDX-License-Identifier: Apache-2.0 */
/* Splits edges of tetrahedra, and tetrahedra.
 *
 * An edge is split with all its tetrahedra, so that they still fit together. In each round a
 * tetrahedron selects the longest of its edges to be split, and edges selected by all their
 * tetrahedra are split; the longest of all is among them. An edge is kept if the rounded midpoint
 * would leave a part without volume.
 *
 * Invariant: tetrahedra stay positive in A, exactly. Cost: O(tetrahedra) per round. */
#include <stdlib.h>

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "morph/solid_map.h"

static const char STAGE[] = "split edges";

#define NONE UINT32_MAX

const int DEFORM_EDGES[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* ---- lists ---- */

static int compare(const void *left, const void *right) {
    const deform_edge a = *(const deform_edge *)left, b = *(const deform_edge *)right;
    return (a > b) - (a < b);
}

static size_t find(const deform_edge *list, size_t count, deform_edge edge) {
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (list[middle] < edge)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && list[low] == edge ? low : count;
}

bool deform_edge_in(const deform_edge *list, size_t count, deform_edge edge) {
    return find(list, count, edge) < count;
}

void deform_edges_sort(deform_edge *list, size_t *count) {
    size_t kept = 0;
    if (*count == 0)
        return;
    qsort(list, *count, sizeof *list, compare);
    for (size_t i = 0; i < *count; i++)
        if (kept == 0 || list[i] != list[kept - 1])
            list[kept++] = list[i];
    *count = kept;
}

/* ---- rounds ---- */

typedef struct splitting {
    deform_mesh *c;
    const deform_edge *edges;
    size_t count;
    uint32_t *about, *named; /* per edge: number of its tetrahedra, and of those that select it */
    uint32_t *middle;        /* per edge: its new vertex */
    uint8_t *over;           /* per edge: split, or kept */
    uint32_t *choice;        /* per tetrahedron of the round */
} splitting;

static const double *place(const splitting *s, uint32_t vertex) {
    return s->c->rest.data + 3 * (size_t)vertex;
}

/* The longest edge of a tetrahedron still to be split; ties go to the lower number. */
static uint32_t select_edge(const splitting *s, size_t t) {
    const uint32_t *corner = s->c->tetrahedra.data + 4 * t;
    uint32_t best = NONE;
    double longest = -1;
    for (int e = 0; e < 6; e++) {
        uint32_t a = corner[DEFORM_EDGES[e][0]], b = corner[DEFORM_EDGES[e][1]];
        size_t i = find(s->edges, s->count, deform_edge_of(a, b));
        if (i == s->count || s->over[i])
            continue;
        double length = vec3_distance_squared(place(s, a), place(s, b));
        s->about[i]++;
        if (length > longest || (length == longest && i < best)) {
            longest = length;
            best = (uint32_t)i;
        }
    }
    return best;
}

static void name_edges(const splitting *s, size_t tetrahedra) {
    for (size_t i = 0; i < s->count; i++) {
        s->about[i] = s->named[i] = 0;
        s->middle[i] = NONE;
    }
    for (size_t t = 0; t < tetrahedra; t++) {
        s->choice[t] = select_edge(s, t);
        if (s->choice[t] != NONE)
            s->named[s->choice[t]]++;
    }
}

static bool is_ready(const splitting *s, uint32_t edge) {
    return edge != NONE && !s->over[edge] && s->named[edge] == s->about[edge];
}

static void middle_of(const double *places, deform_edge edge, double out[3]) {
    const double *a = places + 3 * (size_t)(edge >> 32), *b = places + 3 * (size_t)(uint32_t)edge;
    for (int k = 0; k < 3; k++)
        out[k] = 0.5 * a[k] + 0.5 * b[k];
}

/* Are both parts of a tetrahedron positive in A? */
static bool parts_are_positive(const splitting *s, size_t t, deform_edge edge) {
    const uint32_t *corner = s->c->tetrahedra.data + 4 * t;
    double middle[3];
    middle_of(s->c->rest.data, edge, middle);
    for (int part = 0; part < 2; part++) {
        uint32_t gone = part == 0 ? (uint32_t)edge : (uint32_t)(edge >> 32);
        const double *p[4];
        for (int k = 0; k < 4; k++)
            p[k] = corner[k] == gone ? middle : place(s, corner[k]);
        if (orient3d(p[0], p[1], p[2], p[3]) >= 0)
            return false;
    }
    return true;
}

static void leave_thin(const splitting *s, size_t tetrahedra) {
    for (size_t t = 0; t < tetrahedra; t++)
        if (is_ready(s, s->choice[t]) && !parts_are_positive(s, t, s->edges[s->choice[t]]))
            s->over[s->choice[t]] = 1;
}

static starg_status add_middle(const splitting *s, size_t edge) {
    double rest[3], now[3];
    middle_of(s->c->rest.data, s->edges[edge], rest);
    middle_of(s->c->now.data, s->edges[edge], now);
    s->middle[edge] = (uint32_t)(s->c->rest.count / 3);
    for (int k = 0; k < 3; k++) {
        PUSH(s->c->context, STAGE, &s->c->rest, rest[k]);
        PUSH(s->c->context, STAGE, &s->c->now, now[k]);
    }
    return STARG_OK;
}

/* The tetrahedron keeps the lower end of the edge, a new one gets the upper end. */
static starg_status cut(const splitting *s, size_t t, uint32_t edge) {
    uint32_t lower = (uint32_t)(s->edges[edge] >> 32), upper = (uint32_t)s->edges[edge];
    for (size_t k = 0; k < 4; k++) {
        uint32_t corner = s->c->tetrahedra.data[4 * t + k];
        PUSH(s->c->context, STAGE, &s->c->tetrahedra, corner == lower ? s->middle[edge] : corner);
        if (corner == upper)
            s->c->tetrahedra.data[4 * t + k] = s->middle[edge];
    }
    return STARG_OK;
}

static starg_status split_round(splitting *s, bool *any) {
    size_t tetrahedra = s->c->tetrahedra.count / 4;
    *any = false;
    starg_release(s->c->context, s->choice);
    NEW(s->c->context, STAGE, s->choice, tetrahedra);
    name_edges(s, tetrahedra);
    for (uint32_t i = 0; i < s->count; i++)
        *any = *any || (is_ready(s, i) && s->about[i] > 0);
    leave_thin(s, tetrahedra);
    for (uint32_t i = 0; i < s->count; i++)
        if (is_ready(s, i) && s->about[i] > 0)
            TRY(add_middle(s, i));
    for (size_t t = 0; t < tetrahedra; t++)
        if (s->choice[t] != NONE && s->middle[s->choice[t]] != NONE)
            TRY(cut(s, t, s->choice[t]));
    for (size_t i = 0; i < s->count; i++)
        s->over[i] |= s->middle[i] != NONE;
    return STARG_OK;
}

starg_status deform_split(deform_mesh *c, const deform_edge *edges, size_t count) {
    starg_status status = STARG_OK;
    splitting s = {.c = c, .edges = edges, .count = count};
    bool any = count > 0;
    STARG_NEW(c->context, STAGE, s.about, count);
    STARG_NEW(c->context, STAGE, s.named, count);
    STARG_NEW(c->context, STAGE, s.middle, count);
    STARG_NEW_ZERO(c->context, STAGE, s.over, count);
    while (any)
        STARG_TRY(split_round(&s, &any));
done:
    RELEASE(s.about, s.named, s.middle, s.over, s.choice);
    return status;
}

/* ---- tetrahedra ---- */

/* Would all four parts about the centre be positive? */
static bool has_room(const deform_mesh *c, size_t t, const double centre[3]) {
    const double *corners[4];
    for (int own = 0; own < 4; own++) {
        for (size_t k = 0; k < 4; k++)
            corners[k] =
                (int)k == own ? centre : c->rest.data + 3 * (size_t)c->tetrahedra.data[4 * t + k];
        if (orient3d(corners[0], corners[1], corners[2], corners[3]) >= 0)
            return false;
    }
    return true;
}

static bool is_on_surface(const deform_mesh *c, size_t t) {
    for (size_t k = 0; k < 4; k++)
        if (c->tetrahedra.data[4 * t + k] >= c->fixed)
            return false;
    return true;
}

starg_status deform_fill_flat(deform_mesh *c) {
    size_t count = c->tetrahedra.count / 4;
    for (size_t t = 0; t < count; t++) {
        double centre[3] = {0, 0, 0};
        uint32_t corners[4], middle = (uint32_t)(c->rest.count / 3);
        if (!is_on_surface(c, t))
            continue;
        memcpy(corners, c->tetrahedra.data + 4 * t, sizeof corners);
        for (size_t k = 0; k < 4; k++)
            vec3_along(centre, 0.25, c->rest.data + 3 * (size_t)corners[k], centre);
        if (!has_room(c, t, centre))
            continue;
        for (int k = 0; k < 3; k++) {
            PUSH(c->context, STAGE, &c->rest, centre[k]);
            PUSH(c->context, STAGE, &c->now, centre[k]);
        }
        c->tetrahedra.data[4 * t] = middle;
        for (int own = 1; own < 4; own++)
            for (int k = 0; k < 4; k++)
                PUSH(c->context, STAGE, &c->tetrahedra, k == own ? middle : corners[k]);
    }
    return STARG_OK;
}
