/* SPDX-License-Identifier: Apache-2.0 */
/* Planes of reflex edges [Chazelle 1984].
 *
 * Problem: a plane that brings a region nearer to being convex, whatever it looks like.
 *
 * Method: triangles at an edge, by sorting; an edge is reflex if one of its triangles rises above
 * the plane of the other. Between the planes of both there is room for planes that leave neither
 * side reflex. Of some such planes, the one whose triangles on the larger side are the fewest. One
 * that fails, by rounding, is not found again soon, for all is random.
 *
 * Cost: that of sorting, and some passes over the vertices. */
#include "star/strict/search/search.h"

#include <stdlib.h>

#include "geometry/vec3.h"

enum { TRIES = 12 };

static const double FLAT = 1e-12; /* no more than this above a plane is not above it */

typedef struct ridge {
    uint32_t ends[2], triangle;
} ridge;

typedef struct ridges {
    const region *r;
    STARG_ARRAY(ridge) all;       /* by edge */
    STARG_ARRAY(uint32_t) reflex; /* the first of each reflex edge */
} ridges;

static int compare(const void *x, const void *y) {
    const ridge *a = x, *b = y;
    int order = partition_compare_edges(a->ends[0], a->ends[1], b->ends[0], b->ends[1]);
    return order != 0 ? order : (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static bool same_edge(const ridge *a, const ridge *b) {
    return partition_compare_edges(a->ends[0], a->ends[1], b->ends[0], b->ends[1]) == 0;
}

static starg_status list_edges(ridges *e, starg_context *context) {
    for (uint32_t i = 0; i < e->r->triangles.count; i++) {
        const uint32_t *c = e->r->triangles.data[i].corners;
        for (int k = 0; k < 3; k++) {
            const ridge fresh = {{c[k], c[(k + 1) % 3]}, i};
            PUSH(context, PARTITION_STAGE, &e->all, fresh);
        }
    }
    if (e->all.count > 1)
        qsort(e->all.data, e->all.count, sizeof *e->all.data, compare);
    return STARG_OK;
}

static const double *row_of(const ridges *e, const ridge *at) {
    return e->r->rows.data + 4 * (size_t)e->r->triangles.data[at->triangle].row;
}

/* How far a triangle rises above the plane of another one. */
static double rise(const ridges *e, const ridge *above, const ridge *of) {
    const double *row = row_of(e, of);
    double most = -INFINITY;
    for (int k = 0; k < 3; k++) {
        uint32_t corner = e->r->triangles.data[above->triangle].corners[k];
        most = fmax(most, vec3_dot(row, e->r->vertices.data + 3 * (size_t)corner) - row[3]);
    }
    return most;
}

static starg_status list_reflex(ridges *e, starg_context *context) {
    for (size_t i = 0; i < e->all.count;) {
        const ridge *first = &e->all.data[i];
        size_t count = 1;
        while (i + count < e->all.count && same_edge(first, &e->all.data[i + count]))
            count++;
        if (count > 2 ||
            (count == 2 && fmax(rise(e, first, first + 1), rise(e, first + 1, first)) > FLAT))
            PUSH(context, PARTITION_STAGE, &e->reflex, (uint32_t)i);
        i += count;
    }
    return STARG_OK;
}

/* Between the planes of the first two triangles; either of them, the middle, or any. */
static bool plane_through(const ridges *e, const ridge *first, starg_rng *rng,
                          partition_plane *plane) {
    const double *a = row_of(e, first), *b = row_of(e, first + 1);
    uint64_t sort = starg_rng_below(rng, 4);
    double share = sort == 3 ? starg_rng_unit(rng) : 0.5 * (double)sort;
    for (int k = 0; k < 3; k++)
        plane->normal[k] = (1 - share) * a[k] - share * b[k];
    double length = vec3_length(plane->normal);
    if (length < 1e-6)
        return false;
    for (int k = 0; k < 3; k++)
        plane->normal[k] /= length;
    plane->offset = vec3_dot(plane->normal, e->r->vertices.data + 3 * (size_t)first->ends[0]);
    return true;
}

/* Triangles on the larger side, or all of them if one side has none. */
static size_t weigh(const ridges *e, const partition_plane *plane) {
    size_t above = 0, below = 0, all = e->r->triangles.count;
    for (size_t i = 0; i < all; i++) {
        bool high = false, low = false;
        for (int k = 0; k < 3; k++) {
            const double *v = e->r->vertices.data + 3 * (size_t)e->r->triangles.data[i].corners[k];
            double height = vec3_dot(plane->normal, v) - plane->offset;
            high = high || height > FLAT;
            low = low || height < -FLAT;
        }
        above += high;
        below += low;
    }
    return above == 0 || below == 0 ? SIZE_MAX : above > below ? above : below;
}

starg_status reflex_plane_find(const region *r, starg_rng *rng, region_scratch *scratch,
                               partition_plane *plane, bool *found) {
    starg_status status = STARG_OK;
    starg_context *context = scratch->context;
    ridges e = {.r = r};
    size_t best = SIZE_MAX;
    *found = false;
    STARG_TRY(list_edges(&e, context));
    STARG_TRY(list_reflex(&e, context));
    for (int i = 0; i < TRIES && e.reflex.count > 0; i++) {
        partition_plane fresh;
        const ridge *first = &e.all.data[e.reflex.data[starg_rng_below(rng, e.reflex.count)]];
        if (!plane_through(&e, first, rng, &fresh))
            continue;
        size_t weight = weigh(&e, &fresh);
        if (weight < best) {
            best = weight;
            *plane = fresh;
            *found = true;
        }
    }
done:
    RELEASE(e.all.data, e.reflex.data);
    return status;
}
