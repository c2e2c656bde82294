/* SPDX-License-Identifier: Apache-2.0 */
/* Removal and restoration of the vertices of a triangulated sphere [Hop96].
 *
 * Each vertex stores the cycle of its neighbours. Removing b merges it into a neighbour a: the hole
 * left by its faces is filled by the fan from a. The result is a triangulated sphere exactly if a
 * and b have no common neighbours besides the necessary two. Outside of b's faces the edges between
 * its neighbours are non-crossing chords of a disk; so some neighbour has none, and every vertex
 * can be removed while more than four are left. Vertices of degree above DEGREE wait: there is
 * always one of degree at most five [Euler].
 *
 * It does not use mesh/halfedges.h: every removal is undone later, so each cycle must start where
 * it did (sums over it round accordingly); and relaxation reads the cycles as arrays, far more
 * often than they change.
 *
 * Order: shortest merge first, so that protruding vertices stay long. Cost: O(degree^2) per removal
 * with its neighbourhood, O(log n) for the queue. */
#include "sphere/sphere.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/levels/heap.h"
#include "mesh/topology.h"

static const char STAGE[] = "sphere";
enum { DEGREE = 24 };

static size_t ring_find(const ring *r, uint32_t vertex) {
    size_t i = 0;
    while (i < r->count && r->data[i] != vertex)
        i++;
    return i;
}

/* ---- make ---- */

static starg_status ring_from(rings *r, const starg_mesh *mesh, const uint32_t *twin,
                              uint32_t first) {
    ring *own = &r->of[mesh->faces[first]];
    uint32_t h = first;
    do {
        PUSH(r->context, STAGE, own, mesh->faces[corner_next(h)]);
        h = twin[corner_previous(h)];
    } while (h != first);
    return STARG_OK;
}

starg_status rings_create(starg_context *context, const starg_mesh *mesh, rings **out) {
    SCOPED_BY(rings_drop) rings *r = NULL;
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    *out = NULL;
    TRY(topology_create(context, mesh, &topology));
    NEW_ZERO(context, STAGE, r, 1);
    r->context = context;
    r->positions = mesh->vertices;
    r->vertex_count = r->left = mesh->vertex_count;
    NEW_ZERO(context, STAGE, r->of, r->vertex_count);
    NEW_ZERO(context, STAGE, r->mark, r->vertex_count);
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        if (r->of[mesh->faces[h]].count == 0)
            TRY(ring_from(r, mesh, topology->twin, h));
    *out = r;
    r = NULL;
    return STARG_OK;
}

void rings_free(rings *r) {
    if (r == NULL)
        return;
    for (size_t v = 0; r->of != NULL && v < r->vertex_count; v++)
        STARG_ARRAY_FREE(r->context, &r->of[v]);
    RELEASE(r->of, r->mark, r->removed.data, r->removals.data, r);
}

/* ---- remove ---- */

static void set_marks(rings *r, const ring *of, uint32_t value) {
    for (size_t i = 0; i < of->count; i++)
        r->mark[of->data[i]] = value;
}

/* Number of neighbours of `a` that are marked. */
static size_t count_marked(const rings *r, uint32_t a) {
    size_t count = 0;
    for (size_t i = 0; i < r->of[a].count; i++)
        count += r->mark[r->of[a].data[i]];
    return count;
}

/* Are the triangles positive that fill a vertex's hole from one of its neighbours? Exact. */
static bool is_positive_fan(const ring *around, size_t from, const double *directions) {
    static const double origin[3];
    size_t count = around->count;
    const double *a = directions + 3 * (size_t)around->data[from];
    for (size_t i = 1; i + 1 < count; i++) {
        const double *p = directions + 3 * (size_t)around->data[(from + i) % count];
        const double *q = directions + 3 * (size_t)around->data[(from + i + 1) % count];
        if (orient3d(a, p, q, origin) != 1)
            return false;
    }
    return true;
}

/* The best neighbour to merge b into and its cost; infinite if b must wait. */
static double choose_target(rings *r, const rings_limits *limits, uint32_t b, uint32_t *target) {
    const ring *own = &r->of[b];
    double least = INFINITY;
    *target = b;
    if (own->count > DEGREE || (limits->kept != NULL && limits->kept[b]))
        return least;
    set_marks(r, own, 1);
    for (size_t i = 0; i < own->count; i++) {
        uint32_t a = own->data[i];
        double cost = vec3_distance(r->positions + 3 * (size_t)a, r->positions + 3 * (size_t)b);
        double degree = (double)(r->of[a].count + own->count - 4);
        cost *= fmax(1, degree / 8); /* round neighbourhoods are easier to embed */
        if (cost < least && count_marked(r, a) == 2 &&
            (limits->directions == NULL || is_positive_fan(own, i, limits->directions))) {
            least = cost;
            *target = a;
        }
    }
    set_marks(r, own, 0);
    return least;
}

/* Removes `count` cyclic entries starting at `first`. */
static void ring_drop(ring *r, size_t first, size_t count) {
    for (size_t i = 0; i < count; i++) {
        size_t at = first < r->count ? first : 0;
        memmove(r->data + at, r->data + at + 1, (r->count - at - 1) * sizeof *r->data);
        r->count--;
    }
}

static starg_status ring_insert(starg_context *context, ring *r, size_t at, uint32_t vertex) {
    PUSH(context, STAGE, r, vertex);
    memmove(r->data + at + 1, r->data + at, (r->count - at - 1) * sizeof *r->data);
    r->data[at] = vertex;
    return STARG_OK;
}

/* Records b and its neighbours, starting at a. */
static starg_status record(rings *r, uint32_t b, uint32_t a) {
    const ring *own = &r->of[b];
    size_t first = ring_find(own, a);
    ring_removal removal = {b, (uint32_t)own->count, r->removed.count};
    for (size_t i = 0; i < own->count; i++)
        PUSH(r->context, STAGE, &r->removed, own->data[(first + i) % own->count]);
    PUSH(r->context, STAGE, &r->removals, removal);
    return STARG_OK;
}

/* With the neighbours p0 = a, p1, ..., of b: p1 and the last lose b, those between get a instead,
 * and a gets them in place of b. */
static starg_status merge(rings *r, uint32_t b, uint32_t a) {
    TRY(record(r, b, a));
    const ring_removal *last = &r->removals.data[r->removals.count - 1];
    const uint32_t *p = r->removed.data + last->ring;
    size_t count = last->count, at;
    for (size_t i = 1; i < count; i++) {
        ring *of = &r->of[p[i]];
        at = ring_find(of, b);
        if (i == 1 || i + 1 == count)
            ring_drop(of, at, 1);
        else
            of->data[at] = a;
    }
    at = ring_find(&r->of[a], b);
    ring_drop(&r->of[a], at, 1);
    for (size_t i = 2; i + 1 < count; i++)
        TRY(ring_insert(r->context, &r->of[a], at + i - 2, p[i]));
    r->of[b].count = 0;
    r->left--;
    return STARG_OK;
}

static void enqueue(rings *r, const rings_limits *limits, mesh_heap *heap, uint32_t vertex) {
    uint32_t target;
    double cost = choose_target(r, limits, vertex, &target);
    if (cost < INFINITY)
        heap_set(heap, vertex, cost);
    else
        heap_remove(heap, vertex);
}

starg_status rings_reduce(rings *r, const rings_limits *limits) {
    SCOPED_BY(heap_drop) mesh_heap *heap = NULL;
    uint32_t b, a;
    TRY(heap_create(r->context, r->vertex_count, &heap));
    for (uint32_t v = 0; v < r->vertex_count; v++)
        enqueue(r, limits, heap, v);
    while (r->left > limits->least && heap_pop(heap, &b)) {
        TRY(starg_check_cancel(r->context, STAGE));
        if (choose_target(r, limits, b, &a) == INFINITY)
            continue;
        TRY(merge(r, b, a));
        const ring_removal *last = &r->removals.data[r->removals.count - 1];
        for (size_t i = 0; i < last->count; i++)
            enqueue(r, limits, heap, r->removed.data[last->ring + i]);
    }
    return STARG_OK;
}

/* ---- restore ---- */

starg_status rings_restore(rings *r) {
    ring_removal last = r->removals.data[r->removals.count - 1];
    const uint32_t *p = r->removed.data + last.ring;
    uint32_t a = p[0], b = last.vertex;
    size_t count = last.count;
    for (size_t i = 0; i < count; i++)
        PUSH(r->context, STAGE, &r->of[b], p[i]);
    for (size_t i = 1; i < count; i++) {
        ring *of = &r->of[p[i]];
        if (i == 1) /* the next one counter-clockwise after p2 is b, then a */
            TRY(ring_insert(r->context, of, ring_find(of, a), b));
        else if (i + 1 == count)
            TRY(ring_insert(r->context, of, ring_find(of, a) + 1, b));
        else
            of->data[ring_find(of, a)] = b;
    }
    ring *center = &r->of[a];
    if (count > 3)
        ring_drop(center, ring_find(center, p[2]), count - 3);
    TRY(ring_insert(r->context, center, ring_find(center, p[1]) + 1, b));
    r->removed.count = last.ring;
    r->removals.count--;
    r->left++;
    return STARG_OK;
}
