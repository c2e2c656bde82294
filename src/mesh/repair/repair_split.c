/* SPDX-License-Identifier: Apache-2.0 */
/* Splits a surface where it is not manifold.
 *
 * 1. Faces at edges of more than two are paired (mesh/wings.c). Faces without a partner leave an
 *    open edge for the hole filler.
 * 2. Each fan of corners at a vertex but the first gets a copy of the vertex. This separates
 *    non-manifold vertices and usually the sheets at an edge too.
 * 3. Sheets that are connected at both ends of an edge still share it. All but one pair get their
 *    own vertex in the middle of the edge, and the three stages start again.
 *
 * Cost O(n log n). */

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/repair/repair.h"

enum { MAX_ROUNDS = 16, MOST_STEPS = 8 };

typedef struct splitter {
    repair_state *state;
    mesh_topology *topology; /* with twins at edges of more than two faces */
} splitter;

static bool lowest_on_edge(const mesh_topology *topology, uint32_t h) {
    for (uint32_t o = topology->ring[h]; o != h; o = topology->ring[o])
        if (o < h)
            return false;
    return true;
}

static starg_status split_fans(splitter *s) {
    size_t corners = s->state->faces.count;
    SCOPED uint32_t *fan = NULL;
    SCOPED uint8_t *used = NULL;
    NEW(s->state->context, REPAIR_STAGE, fan, corners);
    NEW_ZERO(s->state->context, REPAIR_STAGE, used, repair_vertex_count(s->state));
    starg_mesh view = repair_view(s->state);
    wings_find_fans(s->topology, &view, fan);
    for (uint32_t h = 0; h < corners; h++) { /* a fan's root is its lowest corner */
        uint32_t root = sets_find(fan, h), *vertex = &s->state->faces.data[h];
        if (root != h) {
            *vertex = s->state->faces.data[root];
        } else if (used[*vertex]) {
            TRY(repair_add_vertex(s->state, repair_position(s->state, *vertex),
                                  s->state->origin.data[*vertex], vertex));
        } else {
            used[*vertex] = 1;
        }
    }
    return STARG_OK;
}

/* Replaces face (u, v, w) by (u, m, w) and (m, v, w), where u v is the edge of h. */
static starg_status split_face(repair_state *state, uint32_t h, uint32_t middle) {
    uint32_t end = state->faces.data[corner_next(h)];
    uint32_t tip = state->faces.data[corner_previous(h)];
    state->faces.data[corner_next(h)] = middle;
    state->flags.data[h / 3] |= REPAIR_ADDED;
    return repair_add_face(state, middle, end, tip, REPAIR_ADDED);
}

/* Does p lie behind the face of h, or in its plane? */
static bool lies_behind(const repair_state *state, uint32_t h, const double p[3]) {
    const uint32_t *corner = state->faces.data + 3 * (size_t)(h / 3);
    return orient3d(repair_position(state, corner[0]), repair_position(state, corner[1]),
                    repair_position(state, corner[2]), p) >= 0;
}

/* The middle of the edge of h, rounded such that it lies behind both faces of the sheet: between
 * them the other sheets are not, and the new faces cross none of theirs. */
static void find_middle(const repair_state *state, uint32_t h, uint32_t other, double middle[3]) {
    const uint32_t side[2] = {h, other != TOPOLOGY_NONE ? other : h};
    const double *a = repair_position(state, state->faces.data[h]);
    const double *b = repair_position(state, state->faces.data[corner_next(h)]);
    double inward[3] = {0, 0, 0}, exact[3], largest = 0;
    for (int i = 0; i < 2; i++) {
        const uint32_t *corner = state->faces.data + 3 * (size_t)(side[i] / 3);
        double normal[3];
        vec3_triangle_normal(repair_position(state, corner[0]), repair_position(state, corner[1]),
                             repair_position(state, corner[2]), normal);
        vec3_along(inward, -1 / vec3_length(normal), normal, inward);
    }
    for (int k = 0; k < 3; k++) {
        middle[k] = exact[k] = 0.5 * a[k] + 0.5 * b[k];
        largest = fmax(largest, fmax(fabs(a[k]), fabs(b[k])));
    }
    double step = nextafter(largest, INFINITY) - largest;
    for (int i = 0; i < MOST_STEPS; i++, step *= 2) {
        if (lies_behind(state, side[0], middle) && lies_behind(state, side[1], middle))
            return;
        vec3_along(exact, step, inward, middle);
    }
    vec3_copy(exact, middle);
}

/* Gives a sheet on a shared edge its own middle vertex, unless one of its faces was split in this
 * round. */
static starg_status split_sheet(splitter *s, uint32_t h, uint8_t *busy, bool *changed) {
    repair_state *state = s->state;
    uint32_t other = s->topology->twin[h], middle_vertex;
    *changed = true;
    if (busy[h / 3] || (other != TOPOLOGY_NONE && busy[other / 3]))
        return STARG_OK;
    double middle[3];
    find_middle(state, h, other, middle);
    TRY(repair_add_vertex(state, middle, REPAIR_NEW, &middle_vertex));
    busy[h / 3] = 1;
    TRY(split_face(state, h, middle_vertex));
    if (other != TOPOLOGY_NONE) {
        busy[other / 3] = 1;
        TRY(split_face(state, other, middle_vertex));
    }
    return STARG_OK;
}

/* Separates sheets that share both ends of an edge; *changed tells whether there are any. */
static starg_status split_shared_edges(splitter *s, bool *changed) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    size_t halfedges = s->state->faces.count;
    SCOPED uint8_t *busy = NULL;
    *changed = false;
    starg_mesh view = repair_view(s->state);
    TRY(topology_create(s->state->context, &view, &topology));
    NEW_ZERO(s->state->context, REPAIR_STAGE, busy, repair_face_count(s->state));
    for (uint32_t h = 0; h < halfedges; h++) {
        if (topology->twin[h] != TOPOLOGY_NONE || topology->ring[h] == h)
            continue;
        if (lowest_on_edge(topology, h))
            continue;
        uint32_t other = s->topology->twin[h];
        if (other != TOPOLOGY_NONE && (other < h || lowest_on_edge(topology, other)))
            continue;
        TRY(split_sheet(s, h, busy, changed));
    }
    return STARG_OK;
}

static starg_status split_once(repair_state *state, bool *changed) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    starg_mesh view = repair_view(state);
    TRY(wings_create(state->context, &view, &topology));
    splitter s = {.state = state, .topology = topology};
    TRY(split_fans(&s));
    return split_shared_edges(&s, changed);
}

starg_status repair_split(repair_state *state) {
    bool changed = true;
    for (int round = 0; round < MAX_ROUNDS && changed; round++) {
        TRY(split_once(state, &changed));
        TRY(starg_check_cancel(state->context, REPAIR_STAGE));
    }
    return STARG_OK;
}
