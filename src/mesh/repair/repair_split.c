/* SPDX-License-Identifier: Apache-2.0 */
/* Splits a surface where it is not manifold.
 *
 * 1. Around every edge of more than two faces, the faces are sorted by angle and matched like
 *    brackets: a face in one direction with the next one in the other direction, with solid between
 *    them. Two cubes that touch along an edge become two shells. Faces without a partner leave an
 *    open edge for the hole filler.
 * 2. Corners at a vertex that are linked across matched edges form a fan; each fan but the first
 *    gets a copy of the vertex. This separates non-manifold vertices and usually the sheets at an
 *    edge too.
 * 3. Sheets that are connected at both ends of an edge still share it. All but one pair get their
 *    own vertex in the middle of the edge, and the three stages start again.
 *
 * The order by angle is exact. Cost O(n log n). */
#include "geometry/predicates.h"
#include "mesh/repair/repair.h"

enum { MAX_ROUNDS = 16 };

typedef struct splitter {
    repair_state *state;
    mesh_topology *topology;
    uint32_t *pair; /* per halfedge: its partner, or TOPOLOGY_NONE */
} splitter;

/* A face at an edge, viewed along the edge from its lower to its upper vertex. */
typedef struct wing {
    uint32_t halfedge;
    const double *tip; /* the corner opposite the edge */
    bool forward;      /* directed from the lower to the upper vertex */
    int sector;        /* relative to the first wing: 0 same, 1 left, 2 opposite, 3 right */
} wing;

typedef STARG_ARRAY(wing) wing_list;

/* Sector of `tip` around line a b, where `first` points up. */
static int sector_of(const double a[3], const double b[3], const double first[3],
                     const double tip[3]) {
    int side = orient3d(a, b, first, tip);
    if (side != 0)
        return side > 0 ? 1 : 3;
    for (int u = 0; u < 3; u++) {
        int turn = orient2d(a, b, first, u, (u + 1) % 3);
        if (turn != 0)
            return orient2d(a, b, tip, u, (u + 1) % 3) * turn < 0 ? 2 : 0;
    }
    return 0;
}

static bool comes_before(const double a[3], const double b[3], const wing *x, const wing *y) {
    if (x->sector != y->sector)
        return x->sector < y->sector;
    int side = x->sector % 2 == 1 ? orient3d(a, b, x->tip, y->tip) : 0;
    return side != 0 ? side > 0 : x->halfedge < y->halfedge;
}

/* Lists the wings of an edge by angle. */
static starg_status sort_wings(const splitter *s, uint32_t halfedge, wing_list *wings) {
    starg_status status = STARG_OK;
    const uint32_t *faces = s->state->faces.data;
    uint32_t low = faces[halfedge], high = faces[corner_next(halfedge)], h = halfedge;
    if (low > high) {
        uint32_t swap = low;
        low = high;
        high = swap;
    }
    const double *a = repair_position(s->state, low), *b = repair_position(s->state, high);
    wings->count = 0;
    do {
        wing own = {.halfedge = h,
                    .tip = repair_position(s->state, faces[corner_previous(h)]),
                    .forward = faces[h] == low};
        STARG_PUSH(s->state->context, REPAIR_STAGE, wings, own);
        h = s->topology->ring[h];
    } while (h != halfedge);
    const double *first = wings->data[0].tip;
    for (size_t i = 0; i < wings->count && collinear(a, b, first); i++)
        first = wings->data[i].tip;
    for (size_t i = 0; i < wings->count; i++) {
        wing own = wings->data[i];
        size_t k = i;
        own.sector = sector_of(a, b, first, own.tip);
        for (; k > 0 && comes_before(a, b, &own, &wings->data[k - 1]); k--)
            wings->data[k] = wings->data[k - 1];
        wings->data[k] = own;
    }
done:
    return status;
}

/* Matches wings like brackets on a circle: the second pass closes those left open. */
static starg_status pair_wings(splitter *s, const wing_list *wings) {
    starg_status status = STARG_OK;
    uint32_t *open = NULL;
    size_t depth = 0;
    STARG_NEW(s->state->context, REPAIR_STAGE, open, 2 * wings->count);
    for (size_t i = 0; i < 2 * wings->count; i++) {
        const wing *own = &wings->data[i % wings->count];
        if (s->pair[own->halfedge] != TOPOLOGY_NONE)
            continue;
        if (own->forward && i < wings->count) {
            open[depth++] = own->halfedge;
        } else if (!own->forward && depth > 0) {
            uint32_t partner = open[--depth];
            s->pair[partner] = own->halfedge;
            s->pair[own->halfedge] = partner;
        }
    }
done:
    starg_release(s->state->context, open);
    return status;
}

static bool lowest_on_edge(const mesh_topology *topology, uint32_t h) {
    for (uint32_t o = topology->ring[h]; o != h; o = topology->ring[o])
        if (o < h)
            return false;
    return true;
}

static starg_status pair_halfedges(splitter *s) {
    starg_status status = STARG_OK;
    wing_list wings = {0};
    memcpy(s->pair, s->topology->twin, s->state->faces.count * sizeof *s->pair);
    for (uint32_t h = 0; h < s->state->faces.count; h++) {
        if (s->topology->twin[h] != TOPOLOGY_NONE || s->topology->ring[h] == h)
            continue;
        if (!lowest_on_edge(s->topology, h))
            continue;
        STARG_TRY(sort_wings(s, h, &wings));
        STARG_TRY(pair_wings(s, &wings));
    }
done:
    STARG_ARRAY_FREE(s->state->context, &wings);
    return status;
}

static starg_status split_fans(splitter *s) {
    starg_status status = STARG_OK;
    size_t corners = s->state->faces.count;
    uint32_t *fan = NULL;
    uint8_t *used = NULL;
    STARG_NEW(s->state->context, REPAIR_STAGE, fan, corners);
    STARG_NEW_ZERO(s->state->context, REPAIR_STAGE, used, repair_vertex_count(s->state));
    sets_make(fan, corners);
    for (uint32_t h = 0; h < corners; h++) {
        uint32_t other = s->pair[h];
        if (other == TOPOLOGY_NONE)
            continue;
        sets_join(fan, h, corner_next(other));
        sets_join(fan, corner_next(h), other);
    }
    for (uint32_t h = 0; h < corners; h++) { /* a fan's root is its lowest corner */
        uint32_t root = sets_find(fan, h), *vertex = &s->state->faces.data[h];
        if (root != h) {
            *vertex = s->state->faces.data[root];
        } else if (used[*vertex]) {
            STARG_TRY(repair_add_vertex(s->state, repair_position(s->state, *vertex),
                                        s->state->origin.data[*vertex], vertex));
        } else {
            used[*vertex] = 1;
        }
    }
done:
    starg_release(s->state->context, fan);
    starg_release(s->state->context, used);
    return status;
}

/* Replaces face (u, v, w) by (u, m, w) and (m, v, w), where u v is the edge of h. */
static starg_status split_face(repair_state *state, uint32_t h, uint32_t middle) {
    uint32_t end = state->faces.data[corner_next(h)];
    uint32_t tip = state->faces.data[corner_previous(h)];
    state->faces.data[corner_next(h)] = middle;
    state->flags.data[h / 3] |= REPAIR_ADDED;
    return repair_add_face(state, middle, end, tip, REPAIR_ADDED);
}

/* Gives a sheet on a shared edge its own middle vertex, unless one of its faces was split in this
 * round. */
static starg_status split_sheet(splitter *s, uint32_t h, uint8_t *busy, bool *changed) {
    starg_status status = STARG_OK;
    repair_state *state = s->state;
    uint32_t other = s->pair[h], middle_vertex;
    *changed = true;
    if (busy[h / 3] || (other != TOPOLOGY_NONE && busy[other / 3]))
        return STARG_OK;
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * repair_position(state, state->faces.data[h])[k] +
                    0.5 * repair_position(state, state->faces.data[corner_next(h)])[k];
    STARG_TRY(repair_add_vertex(state, middle, REPAIR_NEW, &middle_vertex));
    busy[h / 3] = 1;
    STARG_TRY(split_face(state, h, middle_vertex));
    if (other != TOPOLOGY_NONE) {
        busy[other / 3] = 1;
        STARG_TRY(split_face(state, other, middle_vertex));
    }
done:
    return status;
}

/* Separates sheets that share both ends of an edge; *changed tells whether there are any. */
static starg_status split_shared_edges(splitter *s, bool *changed) {
    starg_status status = STARG_OK;
    mesh_topology *topology = NULL;
    size_t halfedges = s->state->faces.count;
    uint8_t *busy = NULL;
    *changed = false;
    starg_mesh view = repair_view(s->state);
    STARG_TRY(topology_create(s->state->context, &view, &topology));
    STARG_NEW_ZERO(s->state->context, REPAIR_STAGE, busy, repair_face_count(s->state));
    for (uint32_t h = 0; h < halfedges; h++) {
        if (topology->twin[h] != TOPOLOGY_NONE || topology->ring[h] == h)
            continue;
        if (lowest_on_edge(topology, h))
            continue;
        uint32_t other = s->pair[h];
        if (other != TOPOLOGY_NONE && (other < h || lowest_on_edge(topology, other)))
            continue;
        STARG_TRY(split_sheet(s, h, busy, changed));
    }
done:
    topology_free(topology);
    starg_release(s->state->context, busy);
    return status;
}

static starg_status split_once(repair_state *state, bool *changed) {
    starg_status status = STARG_OK;
    splitter s = {.state = state};
    starg_mesh view = repair_view(state);
    STARG_TRY(topology_create(state->context, &view, &s.topology));
    STARG_NEW(state->context, REPAIR_STAGE, s.pair, state->faces.count);
    STARG_TRY(pair_halfedges(&s));
    STARG_TRY(split_fans(&s));
    STARG_TRY(split_shared_edges(&s, changed));
done:
    topology_free(s.topology);
    starg_release(state->context, s.pair);
    return status;
}

starg_status repair_split(repair_state *state) {
    starg_status status = STARG_OK;
    bool changed = true;
    for (int round = 0; round < MAX_ROUNDS && changed; round++) {
        STARG_TRY(split_once(state, &changed));
        STARG_TRY(starg_check_cancel(state->context, REPAIR_STAGE));
    }
done:
    return status;
}
