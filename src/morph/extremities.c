/* SPDX-License-Identifier: Apache-2.0 */
/* Extremities: local maxima of the mean geodesic distance to the whole surface.
 *
 * Source: the centricity of M. Hilaga et al., Topology matching for fully automatic similarity
 * estimation of 3D shapes, 2001; it is invariant under bending.
 *
 * Stages: some bases, each the vertex farthest from the earlier ones; distances along edges from
 * each (Dijkstra); their sum; its local maxima among neighbours, in decreasing order, that are
 * neither below the mean nor close to an extremity already found. Cost: O((BASES + extremities) n
 * log n). */
#include "morph/surface_map.h"

#include "geometry/vec3.h"
#include "mesh/levels/heap.h"

static const char STAGE[] = "extremities";
enum { BASES = 12 };
static const double APART =
    0.2; /* of the largest distance: smallest distance between extremities */

typedef struct search {
    const sphere *sphere;
    mesh_heap *heap;
    double *distance; /* to the last source */
    double *nearest;  /* to the nearest of all sources so far */
    double *sum;      /* of the distances to the bases */
} search;

static starg_status spread_from(search *s, uint32_t source) {
    const rings *r = s->sphere->rings;
    uint32_t v = source;
    TRY(starg_check_cancel(r->context, STAGE));
    for (size_t i = 0; i < r->vertex_count; i++)
        s->distance[i] = INFINITY;
    s->distance[source] = 0;
    heap_set(s->heap, source, 0);
    while (heap_pop(s->heap, &v))
        for (size_t i = 0; i < r->of[v].count; i++) {
            uint32_t w = r->of[v].data[i];
            double d = s->distance[v] +
                       vec3_distance(r->positions + 3 * (size_t)v, r->positions + 3 * (size_t)w);
            if (d < s->distance[w]) {
                s->distance[w] = d;
                heap_set(s->heap, w, d);
            }
        }
    for (size_t i = 0; i < r->vertex_count; i++)
        s->nearest[i] = fmin(s->nearest[i], s->distance[i]);
    return STARG_OK;
}

static uint32_t largest(const double *values, size_t count) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; i++)
        if (values[i] > values[best])
            best = i;
    return best;
}

static starg_status measure(search *s) {
    size_t count = s->sphere->rings->vertex_count;
    for (size_t i = 0; i < count; i++)
        s->nearest[i] = INFINITY;
    TRY(spread_from(s, 0)); /* the first base must not depend on the numbering: it is dropped */
    uint32_t base = largest(s->distance, count);
    for (size_t i = 0; i < count; i++)
        s->nearest[i] = INFINITY;
    for (int k = 0; k < BASES; k++) {
        TRY(spread_from(s, base));
        for (size_t i = 0; i < count; i++)
            s->sum[i] += s->distance[i];
        base = largest(s->nearest, count);
    }
    return STARG_OK;
}

static bool is_peak(const search *s, uint32_t v) {
    const ring *around = &s->sphere->rings->of[v];
    for (size_t i = 0; i < around->count; i++)
        if (s->sum[around->data[i]] > s->sum[v])
            return false;
    return true;
}

/* The highest peak far from all extremities; count if there is none. */
static size_t next_peak(const search *s, double floor, double apart) {
    size_t count = s->sphere->rings->vertex_count, best = count;
    for (uint32_t v = 0; v < count; v++)
        if (s->sum[v] > floor && s->nearest[v] > apart &&
            (best == count || s->sum[v] > s->sum[best]) && is_peak(s, v))
            best = v;
    return best;
}

static starg_status collect(search *s, extremity_list *out) {
    size_t count = s->sphere->rings->vertex_count;
    double mean = 0, apart = 0;
    for (size_t i = 0; i < count; i++) {
        mean += s->sum[i] / (double)count;
        s->nearest[i] = INFINITY;
    }
    while (out->count < EXTREMITIES_MOST) {
        size_t extremity = next_peak(s, mean, apart);
        if (extremity == count)
            break;
        out->vertices[out->count++] = (uint32_t)extremity;
        TRY(spread_from(s, (uint32_t)extremity));
        if (out->count == 1)
            apart = APART * s->distance[largest(s->distance, count)];
    }
    return STARG_OK;
}

starg_status extremities_find(const sphere *s, extremity_list *out) {
    starg_status status = STARG_OK;
    starg_context *context = s->context;
    size_t count = s->rings->vertex_count;
    search work = {.sphere = s};
    *out = (extremity_list){0};
    STARG_TRY(heap_create(context, count, &work.heap));
    STARG_NEW(context, STAGE, work.distance, count);
    STARG_NEW(context, STAGE, work.nearest, count);
    STARG_NEW_ZERO(context, STAGE, work.sum, count);
    STARG_TRY(measure(&work));
    STARG_TRY(collect(&work, out));
done:
    heap_free(work.heap);
    RELEASE(work.distance, work.nearest, work.sum);
    return status;
}
