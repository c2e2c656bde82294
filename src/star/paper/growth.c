/* SPDX-License-Identifier: Apache-2.0 */
/* Region growing by node merging [YL11, section 4].
 *
 * Problem: give each tetrahedron one colour, so that a tetrahedron of colour c is visible from
 * guard c, and everything that its visibility depends on has colour c before it.
 *
 * A node is merged into a region when all its predecessors in that colour have it, and the region
 * has a face of it: it is then offered that colour, at the cost f(g, n), and among all offers the
 * biggest is taken first, since most depends on it. Each node holds its best offer only.
 *
 * Relaxed, for what is left: a tetrahedron next to a region is taken when its guard sees some of
 * its vertices. Those of which it sees all come first, then three, then two. Where there may be no
 * more guards, the rest goes to the regions that it touches, the nearest guard first.
 *
 * Invariants: regions hang together by faces; a colour is never changed; offers stay valid, because
 * colours do. Ties go to the lower colour, then to the lower tetrahedron. Cost: O(n log n) for n
 * coloured tetrahedra. */
#include "star/paper/state.h"

#include "geometry/vec3.h"

static const paper_guard *guard_of(const paper_front *front, int32_t colour) {
    return &front->guards[colour - front->first_colour];
}

static bool in_front(const paper_front *front, int32_t colour) {
    return colour >= front->first_colour && (size_t)(colour - front->first_colour) < front->count;
}

/* Enters an offer unless the tetrahedron has a better one; the lower key is the better. */
static void offer(paper_state *s, uint32_t tetrahedron, int32_t colour, double key) {
    if (heap_contains(s->heap, tetrahedron)) {
        double known = s->heap->entries[s->heap->slot[tetrahedron]].key;
        if (known < key || (known == key && s->offer[tetrahedron] <= colour))
            return;
    }
    s->offer[tetrahedron] = colour;
    heap_set(s->heap, tetrahedron, key);
}

/* ---- strict ---- */

static bool touches(const paper_state *s, uint32_t tetrahedron, int32_t colour) {
    for (size_t k = 0; k < 4; k++) {
        uint32_t next = s->mesh->neighbours[4 * (size_t)tetrahedron + k];
        if (next != PAPER_NONE && s->labels[next] == colour)
            return true;
    }
    return false;
}

/* Predecessors may share but a vertex with a tetrahedron; a region hangs together by faces. */
static bool is_ready(const paper_state *s, const paper_guard *g, uint32_t tetrahedron,
                     int32_t colour) {
    if (dependency_seen(s, g, tetrahedron) < 4 || !touches(s, tetrahedron, colour))
        return false;
    for (int k = 0; k < 4; k++) {
        uint32_t p = dependency_predecessor(s, g, tetrahedron, k);
        if (p != PAPER_NONE && s->labels[p] != colour)
            return false;
    }
    return true;
}

static void offer_if_ready(paper_state *s, const paper_guard *g, uint32_t tetrahedron,
                           int32_t colour) {
    if (tetrahedron != PAPER_NONE && s->labels[tetrahedron] < 0 &&
        is_ready(s, g, tetrahedron, colour))
        offer(s, tetrahedron, colour, -(double)g->cost[tetrahedron]);
}

/* What may have waited for a tetrahedron: those at its vertices from which the segment to the guard
 * runs into it, and its neighbours. */
static void spread(paper_state *s, const paper_guard *g, uint32_t tetrahedron, int32_t colour) {
    for (size_t k = 0; k < 4; k++) {
        uint32_t v = s->mesh->tetrahedra[4 * (size_t)tetrahedron + k];
        for (size_t i = s->rings.first[v]; g->toward[v] == tetrahedron && i < s->rings.first[v + 1];
             i++)
            offer_if_ready(s, g, s->rings.at[i], colour);
        offer_if_ready(s, g, s->mesh->neighbours[4 * (size_t)tetrahedron + k], colour);
    }
}

void growth_strict(paper_state *s, const paper_front *front) {
    uint32_t t;
    for (size_t i = 0; i < front->count; i++)
        if (s->labels[front->guards[i].home] < 0)
            s->labels[front->guards[i].home] = front->first_colour + (int32_t)i;
    for (size_t i = 0; i < front->count; i++) {
        int32_t colour = front->first_colour + (int32_t)i;
        if (s->labels[front->guards[i].home] == colour)
            spread(s, &front->guards[i], front->guards[i].home, colour);
    }
    while (heap_pop(s->heap, &t)) {
        s->labels[t] = s->offer[t];
        spread(s, guard_of(front, s->labels[t]), t, s->labels[t]);
    }
}

/* ---- relaxed ---- */

/* As a fraction of the diagonal, which nothing of the model's size makes over- or underflow. */
static double distance_to(const paper_state *s, const double guard[3], uint32_t tetrahedron) {
    double d[3];
    paper_centroid(s, tetrahedron, d);
    vec3_subtract(d, guard, d);
    return hypot(hypot(d[0], d[1]), d[2]) / s->diagonal;
}

static void offer_if_seen(paper_state *s, const paper_front *front, uint32_t tetrahedron,
                          int32_t colour, int least) {
    if (s->labels[tetrahedron] >= 0 || !in_front(front, colour))
        return;
    const paper_guard *g = guard_of(front, colour);
    int seen = dependency_seen(s, g, tetrahedron);
    if (seen >= least)
        offer(s, tetrahedron, colour, 4 - seen + 0.5 * distance_to(s, g->position, tetrahedron));
}

void growth_relaxed(paper_state *s, const paper_front *front, const uint32_t *domain, size_t count,
                    int least) {
    uint32_t t;
    for (size_t i = 0; i < 4 * count; i++) {
        uint32_t next = s->mesh->neighbours[4 * (size_t)domain[i / 4] + i % 4];
        if (next != PAPER_NONE && s->labels[next] >= 0)
            offer_if_seen(s, front, domain[i / 4], s->labels[next], least);
    }
    while (heap_pop(s->heap, &t)) {
        s->labels[t] = s->offer[t];
        for (size_t k = 0; k < 4; k++) {
            uint32_t next = s->mesh->neighbours[4 * (size_t)t + k];
            if (next != PAPER_NONE)
                offer_if_seen(s, front, next, s->labels[t], least);
        }
    }
}

/* ---- whatever is left ---- */

static void offer_any(paper_state *s, uint32_t tetrahedron, int32_t colour) {
    if (s->labels[tetrahedron] < 0)
        offer(s, tetrahedron, colour,
              distance_to(s, s->guards.data + 3 * (size_t)colour, tetrahedron));
}

void growth_absorb(paper_state *s, const uint32_t *domain, size_t count) {
    uint32_t t;
    for (size_t i = 0; i < 4 * count; i++) {
        uint32_t next = s->mesh->neighbours[4 * (size_t)domain[i / 4] + i % 4];
        if (next != PAPER_NONE && s->labels[next] >= 0)
            offer_any(s, domain[i / 4], s->labels[next]);
    }
    while (heap_pop(s->heap, &t)) {
        s->labels[t] = s->offer[t];
        for (size_t k = 0; k < 4; k++) {
            uint32_t next = s->mesh->neighbours[4 * (size_t)t + k];
            if (next != PAPER_NONE)
                offer_any(s, next, s->labels[t]);
        }
    }
}
