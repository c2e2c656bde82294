/* SPDX-License-Identifier: Apache-2.0 */
/* Collapse, flip and split on a halfedge mesh.
 *
 * Invariants: twins of living faces are mutual and have opposite directions; `leaving` names a
 * halfedge of each vertex that has faces; nothing is renumbered.
 *
 * Cost: constant, except collapse and halfedge search, which take the degree of the vertex. */
#include "mesh/halfedges.h"

starg_status halfedges_create(const mesh_topology *topology, const starg_mesh *mesh,
                              const char *stage, mesh_halfedges *out) {
    starg_context *context = topology->context;
    size_t halfedges = 3 * mesh->face_count;
    *out = (mesh_halfedges){.context = context, .stage = stage};
    NEW(context, stage, out->corners.data, halfedges);
    NEW(context, stage, out->twins.data, halfedges);
    NEW(context, stage, out->leaving.data, mesh->vertex_count);
    out->corners.count = out->corners.capacity = halfedges;
    out->twins.count = out->twins.capacity = halfedges;
    out->leaving.count = out->leaving.capacity = mesh->vertex_count;
    memcpy(out->corners.data, mesh->faces, halfedges * sizeof *mesh->faces);
    memcpy(out->twins.data, topology->twin, halfedges * sizeof *topology->twin);
    memset(out->leaving.data, 0xff, mesh->vertex_count * sizeof *out->leaving.data);
    for (uint32_t h = 0; h < halfedges; h++)
        out->leaving.data[mesh->faces[h]] = h;
    return STARG_OK;
}

/* TO = a copy of the growable array FROM with the same capacity; returns on failure. */
#define COPY_ARRAY(CONTEXT, STAGE, FROM, TO)                                                       \
    do {                                                                                           \
        NEW((CONTEXT), (STAGE), (TO)->data, (FROM)->capacity);                                     \
        (TO)->count = (FROM)->count;                                                               \
        (TO)->capacity = (FROM)->capacity;                                                         \
        memcpy((TO)->data, (FROM)->data, (FROM)->count * sizeof *(FROM)->data);                    \
    } while (0)

starg_status halfedges_copy(const mesh_halfedges *m, mesh_halfedges *out) {
    *out = (mesh_halfedges){.context = m->context, .stage = m->stage};
    COPY_ARRAY(m->context, m->stage, &m->corners, &out->corners);
    COPY_ARRAY(m->context, m->stage, &m->twins, &out->twins);
    COPY_ARRAY(m->context, m->stage, &m->leaving, &out->leaving);
    return STARG_OK;
}

void halfedges_free(mesh_halfedges *m) {
    RELEASE(m->corners.data, m->twins.data, m->leaving.data);
    *m = (mesh_halfedges){0};
}

size_t halfedges_ring(const mesh_halfedges *m, uint32_t v, uint32_t *ring, size_t most) {
    size_t count = 0;
    uint32_t first = m->leaving.data[v], h = first;
    do {
        if (count == most)
            return 0;
        ring[count++] = h;
        h = halfedges_turn(m, h);
    } while (h != first);
    return count;
}

uint32_t halfedges_find(const mesh_halfedges *m, uint32_t v, uint32_t w) {
    uint32_t first = m->leaving.data[v], h = first;
    do {
        if (halfedges_end(m, h) == w)
            return h;
        h = halfedges_turn(m, h);
    } while (h != first);
    return TOPOLOGY_NONE;
}

size_t halfedges_common(const mesh_halfedges *m, const uint32_t *a, size_t a_count,
                        const uint32_t *b, size_t b_count) {
    size_t common = 0;
    for (size_t i = 0; i < a_count; i++)
        for (size_t j = 0; j < b_count; j++)
            common += halfedges_end(m, a[i]) == halfedges_end(m, b[j]);
    return common;
}

static void join_twins(mesh_halfedges *m, uint32_t g, uint32_t h) {
    m->twins.data[g] = h;
    m->twins.data[h] = g;
}

/* ---- collapse ---- */

/* Removes a face whose corner at `halfedge` was merged with the previous corner: its other two
 * sides become one edge. */
static void close_face(mesh_halfedges *m, uint32_t halfedge) {
    uint32_t g = m->twins.data[corner_next(halfedge)];
    uint32_t h = m->twins.data[corner_previous(halfedge)];
    join_twins(m, g, h);
    m->leaving.data[halfedges_start(m, g)] = g;
    m->leaving.data[halfedges_start(m, h)] = h;
    memset(m->twins.data + 3 * (size_t)(halfedge / 3), 0xff, 3 * sizeof *m->twins.data);
}

void halfedges_collapse(mesh_halfedges *m, uint32_t h) {
    uint32_t twin = m->twins.data[h], a = halfedges_start(m, h), b = halfedges_end(m, h);
    uint32_t turned = twin;
    do { /* corners keep their halfedges: halfedges_turn does not read corners */
        m->corners.data[turned] = a;
        turned = halfedges_turn(m, turned);
    } while (turned != twin);
    close_face(m, twin);
    close_face(m, h);
    m->leaving.data[b] = TOPOLOGY_NONE;
}

/* ---- flip and split ---- */

/* Writes a face and makes its halfedges the `leaving` ones of its corners. */
static void set_face(mesh_halfedges *m, uint32_t face, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t v[3] = {a, b, c};
    for (uint32_t k = 0; k < 3; k++) {
        m->corners.data[3 * face + k] = v[k];
        m->leaving.data[v[k]] = 3 * face + k;
    }
}

static starg_status add_face(mesh_halfedges *m, uint32_t *face) {
    *face = (uint32_t)(m->corners.count / 3);
    for (int k = 0; k < 3; k++) {
        PUSH(m->context, m->stage, &m->corners, 0);
        PUSH(m->context, m->stage, &m->twins, TOPOLOGY_NONE);
    }
    return STARG_OK;
}

static starg_status add_vertex(mesh_halfedges *m, uint32_t *vertex) {
    *vertex = (uint32_t)m->leaving.count;
    PUSH(m->context, m->stage, &m->leaving, TOPOLOGY_NONE);
    return STARG_OK;
}

/* An edge u v between faces u v w and v u x, and the twins of their other sides. */
typedef struct edge_pair {
    uint32_t f, g;           /* the faces */
    uint32_t u, v, w, x;     /* the corners */
    uint32_t vw, wu, ux, xv; /* twins of these halfedges */
} edge_pair;

static edge_pair pair_at(const mesh_halfedges *m, uint32_t h) {
    uint32_t t = m->twins.data[h];
    return (edge_pair){.f = h / 3,
                       .g = t / 3,
                       .u = halfedges_start(m, h),
                       .v = halfedges_end(m, h),
                       .w = halfedges_apex(m, h),
                       .x = halfedges_apex(m, t),
                       .vw = m->twins.data[corner_next(h)],
                       .wu = m->twins.data[corner_previous(h)],
                       .ux = m->twins.data[corner_next(t)],
                       .xv = m->twins.data[corner_previous(t)]};
}

void halfedges_flip(mesh_halfedges *m, uint32_t h) {
    edge_pair e = pair_at(m, h);
    uint32_t f = 3 * e.f, g = 3 * e.g;
    set_face(m, e.f, e.w, e.u, e.x);
    set_face(m, e.g, e.x, e.v, e.w);
    join_twins(m, f, e.wu);
    join_twins(m, f + 1, e.ux);
    join_twins(m, f + 2, g + 2);
    join_twins(m, g, e.xv);
    join_twins(m, g + 1, e.vw);
}

void halfedges_begin_face(mesh_halfedges *m, uint32_t h) {
    uint32_t next = corner_next(h), last = corner_previous(h), first = h - h % 3;
    const uint32_t twins[3] = {m->twins.data[h], m->twins.data[next], m->twins.data[last]};
    set_face(m, h / 3, halfedges_start(m, h), halfedges_start(m, next), halfedges_start(m, last));
    for (uint32_t k = 0; k < 3; k++)
        join_twins(m, first + k, twins[k]);
}

/* The faces become u p w, p v w, v p x and p u x. */
starg_status halfedges_split_edge(mesh_halfedges *m, uint32_t h, uint32_t *vertex) {
    edge_pair e = pair_at(m, h);
    uint32_t f = 3 * e.f, g = 3 * e.g, f2, g2, p;
    TRY(add_vertex(m, &p));
    TRY(add_face(m, &f2));
    TRY(add_face(m, &g2));
    set_face(m, e.f, e.u, p, e.w);
    set_face(m, f2, p, e.v, e.w);
    set_face(m, e.g, e.v, p, e.x);
    set_face(m, g2, p, e.u, e.x);
    join_twins(m, f, 3 * g2);
    join_twins(m, f + 1, 3 * f2 + 2);
    join_twins(m, f + 2, e.wu);
    join_twins(m, 3 * f2, g);
    join_twins(m, 3 * f2 + 1, e.vw);
    join_twins(m, g + 1, 3 * g2 + 2);
    join_twins(m, g + 2, e.xv);
    join_twins(m, 3 * g2 + 1, e.ux);
    *vertex = p;
    return STARG_OK;
}

/* Face a b c becomes a b p, b c p and c a p. */
starg_status halfedges_split_face(mesh_halfedges *m, uint32_t face, uint32_t *vertex) {
    uint32_t v[3], beyond[3], part[3] = {face}, p;
    for (uint32_t k = 0; k < 3; k++) {
        v[k] = m->corners.data[3 * face + k];
        beyond[k] = m->twins.data[3 * face + k];
    }
    TRY(add_vertex(m, &p));
    TRY(add_face(m, &part[1]));
    TRY(add_face(m, &part[2]));
    for (int k = 0; k < 3; k++)
        set_face(m, part[k], v[k], v[(k + 1) % 3], p);
    for (int k = 0; k < 3; k++) {
        join_twins(m, 3 * part[k], beyond[k]);
        join_twins(m, 3 * part[k] + 1, 3 * part[(k + 1) % 3] + 2);
    }
    *vertex = p;
    return STARG_OK;
}

/* ---- compaction ---- */

uint32_t halfedges_compact(const mesh_halfedges *m, uint32_t *number, uint32_t *faces) {
    uint32_t count = 0;
    for (size_t v = 0; v < m->leaving.count; v++)
        if (m->leaving.data[v] != TOPOLOGY_NONE)
            number[v] = count++;
    for (size_t f = 0; f < m->corners.count / 3; f++)
        for (size_t k = 0; k < 3 && halfedges_face_lives(m, f); k++)
            *faces++ = number[m->corners.data[3 * f + k]];
    return count;
}
