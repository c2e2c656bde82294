/* SPDX-License-Identifier: Apache-2.0 */
/* Fills holes: loops of open edges, one by one. If no filling keeps the mesh manifold, or all of
 * them cross something, a fan about the loop's centre is tried.
 *
 * Where two holes meet in a vertex, that vertex was split earlier, which merged the holes into one
 * loop through both copies. Such copies are first joined again, which splits the loop in two:
 * filling both makes one fan. Joining requires that the copies have no common neighbour, which
 * would duplicate an edge. */
#include "mesh/repair/repair.h"

/* Longer loops are not searched for copies of a vertex. */
enum { MAX_STEPS = 1 << 14 };

typedef struct filler {
    repair_state *state;
    uint32_t *out;   /* per vertex: the open halfedge from it, or TOPOLOGY_NONE */
    uint32_t *end;   /* per vertex: the next one on its loop */
    uint32_t *alias; /* per vertex: itself, or the copy it was joined with */
    repair_stars stars;
    repair_keys edges; /* of the growing mesh */
    repair_index index;
    fill_list loop, triangles;
} filler;

/* The key of the edge between two vertices. */
static uint64_t repair_edge_key(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

static bool edge_is_taken(const void *user, uint32_t a, uint32_t b) {
    return repair_keys_have(user, repair_edge_key(a, b));
}

static starg_status add_edges(filler *f, const uint32_t corner[3]) {
    for (int k = 0; k < 3; k++)
        TRY(repair_keys_add(f->state->context, &f->edges,
                            repair_edge_key(corner[k], corner[(k + 1) % 3])));
    return STARG_OK;
}

static starg_status find_open_edges(filler *f) {
    SCOPED_BY(topology_drop) mesh_topology *topology = NULL;
    starg_mesh view = repair_view(f->state);
    TRY(topology_create(f->state->context, &view, &topology));
    NEW(f->state->context, REPAIR_STAGE, f->out, view.vertex_count);
    NEW(f->state->context, REPAIR_STAGE, f->end, view.vertex_count);
    NEW(f->state->context, REPAIR_STAGE, f->alias, view.vertex_count);
    for (size_t v = 0; v < view.vertex_count; v++)
        f->out[v] = TOPOLOGY_NONE;
    sets_make(f->alias, view.vertex_count);
    for (uint32_t h = 0; h < 3 * view.face_count; h++) {
        if (h % 3 == 0)
            TRY(add_edges(f, view.faces + h));
        if (topology->ring[h] != h)
            continue;
        f->out[view.faces[h]] = h;
        f->end[view.faces[h]] = view.faces[corner_next(h)];
    }
    return STARG_OK;
}

/* Finds the predecessors of v and w on their common loop, if both parts have at least three
 * edges. */
static bool find_before(const filler *f, uint32_t v, uint32_t w, uint32_t *before_v,
                        uint32_t *before_w) {
    size_t steps = 0, to_w = 0;
    uint32_t at = v;
    do {
        uint32_t next = f->end[at];
        steps++;
        if (next == w) {
            to_w = steps;
            *before_w = at;
        }
        *before_v = at;
        at = next;
    } while (at != v && f->out[at] != TOPOLOGY_NONE && steps < MAX_STEPS);
    return at == v && to_w >= 3 && steps - to_w >= 3;
}

static bool have_common_neighbour(const filler *f, uint32_t v, uint32_t w) {
    for (size_t i = f->stars.start[w]; i < f->stars.start[w + 1]; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t near = repair_face(f->state, f->stars.list[i])[k];
            if (near == v || repair_keys_have(&f->edges, repair_edge_key(v, near)))
                return true;
        }
    return false;
}

/* Replaces w by v in its faces and splits their loop. */
static starg_status join_copies(filler *f, uint32_t v, uint32_t w, bool *joined) {
    uint32_t before_v, before_w;
    *joined = false;
    if (!find_before(f, v, w, &before_v, &before_w) || have_common_neighbour(f, v, w))
        return STARG_OK;
    for (size_t i = f->stars.start[w]; i < f->stars.start[w + 1]; i++) {
        uint32_t *corner = repair_face(f->state, f->stars.list[i]);
        for (int k = 0; k < 3; k++)
            corner[k] = corner[k] == w ? v : corner[k];
        TRY(add_edges(f, corner));
    }
    f->alias[w] = v;
    f->end[before_v] = w;
    f->end[before_w] = v;
    *joined = true;
    return STARG_OK;
}

/* Tries to join open copies of the same vertex in pairs. */
static starg_status join_split_vertices(filler *f) {
    SCOPED uint32_t *waiting = NULL;
    size_t inputs = f->state->input->vertex_count;
    NEW(f->state->context, REPAIR_STAGE, waiting, inputs);
    TRY(repair_stars_create(f->state, &f->stars));
    for (size_t v = 0; v < inputs; v++)
        waiting[v] = TOPOLOGY_NONE;
    for (uint32_t v = 0; v < repair_vertex_count(f->state); v++) {
        uint32_t origin = f->state->origin.data[v];
        bool joined = false;
        if (f->out[v] == TOPOLOGY_NONE || origin == REPAIR_NEW)
            continue;
        if (waiting[origin] != TOPOLOGY_NONE)
            TRY(join_copies(f, waiting[origin], v, &joined));
        waiting[origin] = joined ? TOPOLOGY_NONE : v;
    }
    return STARG_OK;
}

/* Collects the loop through `first`, against the direction of its faces, and marks it as closed.
 * False if the open edges do not form a loop. */
static starg_status collect_loop(filler *f, uint32_t first, bool *closed) {
    uint32_t v = first;
    f->loop.count = 0;
    while (f->out[v] != TOPOLOGY_NONE) {
        PUSH(f->state->context, REPAIR_STAGE, &f->loop, f->alias[v]);
        f->out[v] = TOPOLOGY_NONE;
        v = f->end[v];
    }
    *closed = v == first && f->loop.count >= 3;
    for (size_t i = 0, j = f->loop.count; i + 1 < j; i++) {
        uint32_t swap = f->loop.data[--j];
        f->loop.data[j] = f->loop.data[i];
        f->loop.data[i] = swap;
    }
    return STARG_OK;
}

static size_t count_crossing(const filler *f, const fill_list *triangles) {
    size_t count = 0;
    for (size_t i = 0; i < triangles->count; i += 3)
        count += repair_index_crosses(&f->index, triangles->data + i);
    return count;
}

static starg_status make_fan(filler *f, uint32_t centre) {
    for (size_t i = 0; i < f->loop.count; i++) {
        PUSH(f->state->context, REPAIR_STAGE, &f->triangles, f->loop.data[i]);
        PUSH(f->state->context, REPAIR_STAGE, &f->triangles, f->loop.data[(i + 1) % f->loop.count]);
        PUSH(f->state->context, REPAIR_STAGE, &f->triangles, centre);
    }
    return STARG_OK;
}

/* A fan about the loop's centre: always manifold. Used if no filling is possible or it has fewer
 * than `faults` crossings; an unused centre vertex is dropped later. */
static starg_status try_fan(filler *f, size_t faults) {
    SCOPED fill_list filling = f->triangles;
    double centre[3] = {0, 0, 0};
    uint32_t vertex;
    for (size_t i = 0; i < f->loop.count; i++)
        for (int k = 0; k < 3; k++)
            centre[k] += repair_position(f->state, f->loop.data[i])[k] / (double)f->loop.count;
    f->triangles = (fill_list){0};
    TRY(repair_add_vertex(f->state, centre, REPAIR_NEW, &vertex));
    TRY(make_fan(f, vertex));
    if (count_crossing(f, &f->triangles) >= faults) {
        fill_list fan = f->triangles;
        f->triangles = filling;
        filling = fan;
    }
    return STARG_OK;
}

static starg_status fill_loop(filler *f) {
    fill_job job = {f->state, &f->index, edge_is_taken, &f->edges};
    size_t faults;
    bool possible;
    f->triangles.count = 0;
    TRY(repair_fill(&job, f->loop.data, f->loop.count, &f->triangles, &faults, &possible));
    if (!possible || faults > 0)
        TRY(try_fan(f, possible ? faults : SIZE_MAX));
    for (size_t i = 0; i < f->triangles.count; i += 3) {
        const uint32_t *corner = f->triangles.data + i;
        TRY(repair_add_face(f->state, corner[0], corner[1], corner[2],
                            REPAIR_ADDED | REPAIR_FILLED));
        TRY(add_edges(f, corner));
    }
    f->state->report.holes_filled++;
    return STARG_OK;
}

/* Rebuilds the index when many faces were added. */
static starg_status refresh_index(filler *f) {
    if (f->index.state != NULL && !repair_index_is_stale(&f->index))
        return STARG_OK;
    repair_index_free(&f->index);
    return repair_index_create(f->state, &f->index);
}

static bool is_small_enough(const filler *f) {
    size_t most = f->state->options.max_hole_edges;
    return most == 0 || f->loop.count <= most;
}

starg_status repair_fill_holes(repair_state *state) {
    starg_status status = STARG_OK;
    filler f = {.state = state};
    size_t count = repair_vertex_count(state);
    bool closed = false;
    STARG_TRY(find_open_edges(&f));
    STARG_TRY(join_split_vertices(&f));
    for (uint32_t v = 0; v < count; v++) {
        if (f.out[v] == TOPOLOGY_NONE)
            continue;
        STARG_TRY(collect_loop(&f, v, &closed));
        if (!closed || !is_small_enough(&f))
            continue;
        STARG_TRY(refresh_index(&f));
        STARG_TRY(fill_loop(&f));
        STARG_TRY(starg_check_cancel(state->context, REPAIR_STAGE));
    }
done:
    RELEASE(f.out, f.end, f.alias);
    repair_stars_free(&f.stars);
    starg_release(state->context, f.edges.slots);
    repair_index_free(&f.index);
    RELEASE(f.loop.data, f.triangles.data);
    return status;
}
