/* SPDX-License-Identifier: Apache-2.0 */
/* Finds edges by sorting the halfedges of each lower vertex by upper vertex; the faces of an edge
 * are chained by halfedge number. */
#include "mesh/topology.h"

#include <stdlib.h>

/* A halfedge, stored at the lower of its two vertices. */
typedef struct entry {
    uint32_t upper, halfedge;
} entry;

static int compare_entries(const void *left, const void *right) {
    const entry *a = left, *b = right;
    if (a->upper != b->upper)
        return a->upper < b->upper ? -1 : 1;
    return (a->halfedge > b->halfedge) - (a->halfedge < b->halfedge);
}

void sets_make(uint32_t *parent, size_t count) {
    for (size_t i = 0; i < count; i++)
        parent[i] = (uint32_t)i;
}

uint32_t sets_find(uint32_t *parent, uint32_t item) {
    while (parent[item] != item) {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    return item;
}

void sets_join(uint32_t *parent, uint32_t a, uint32_t b) {
    a = sets_find(parent, a);
    b = sets_find(parent, b);
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

/* Counting sort of the halfedges by lower vertex; start has vertex_count + 1 entries. */
static void file_halfedges(const starg_mesh *mesh, size_t *start, entry *entries) {
    size_t halfedges = 3 * mesh->face_count;
    for (size_t h = 0; h < halfedges; h++) {
        uint32_t a = mesh->faces[h], b = mesh->faces[corner_next((uint32_t)h)];
        start[(a < b ? a : b) + 1]++;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        start[v + 1] += start[v];
    for (size_t h = halfedges; h-- > 0;) {
        uint32_t a = mesh->faces[h], b = mesh->faces[corner_next((uint32_t)h)];
        size_t slot = --start[(a < b ? a : b) + 1];
        entries[slot] = (entry){a < b ? b : a, (uint32_t)h};
    }
}

/* Chains the halfedges of one edge; pairs them if there are two. */
static void link_edge(mesh_topology *topology, uint32_t *parent, const entry *first, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint32_t next = first[(i + 1) % count].halfedge;
        topology->ring[first[i].halfedge] = next;
        topology->twin[first[i].halfedge] = count == 2 ? next : TOPOLOGY_NONE;
        sets_join(parent, first[i].halfedge / 3, next / 3);
    }
    topology->edge_count++;
}

static void link_edges(mesh_topology *topology, uint32_t *parent, const size_t *start,
                       entry *entries) {
    for (size_t v = 0; v < topology->vertex_count; v++) {
        /* start was shifted by one while filling: the entries of v begin at start[v + 1] */
        size_t low = start[v + 1];
        size_t high = v + 1 < topology->vertex_count ? start[v + 2] : 3 * topology->face_count;
        qsort(entries + low, high - low, sizeof *entries, compare_entries);
        while (low < high) {
            size_t count = 1;
            while (low + count < high && entries[low + count].upper == entries[low].upper)
                count++;
            link_edge(topology, parent, entries + low, count);
            low += count;
        }
    }
}

static void number_components(mesh_topology *topology, uint32_t *parent) {
    for (size_t f = 0; f < topology->face_count; f++) {
        uint32_t root = sets_find(parent, (uint32_t)f);
        topology->component[f] =
            root == f ? (uint32_t)topology->component_count++ : topology->component[root];
    }
}

starg_status topology_create(starg_context *context, const starg_mesh *mesh, mesh_topology **out) {
    SCOPED_BY(topology_drop) mesh_topology *result = NULL;
    SCOPED size_t *start = NULL;
    SCOPED entry *entries = NULL;
    SCOPED uint32_t *parent = NULL;
    *out = NULL;
    if (mesh->face_count > UINT32_MAX / 3)
        return starg_fail(context, STARG_ERROR_MESH, "topology",
                          "%zu faces are more than the %u whose edges can be numbered",
                          mesh->face_count, UINT32_MAX / 3);
    NEW_ZERO(context, "topology", result, 1);
    result->context = context;
    result->vertex_count = mesh->vertex_count;
    result->face_count = mesh->face_count;
    NEW(context, "topology", result->twin, 3 * mesh->face_count);
    NEW(context, "topology", result->ring, 3 * mesh->face_count);
    NEW(context, "topology", result->component, mesh->face_count);
    NEW_ZERO(context, "topology", start, mesh->vertex_count + 2);
    NEW(context, "topology", entries, 3 * mesh->face_count);
    NEW(context, "topology", parent, mesh->face_count);
    sets_make(parent, mesh->face_count);
    file_halfedges(mesh, start, entries);
    link_edges(result, parent, start, entries);
    number_components(result, parent);
    *out = result;
    result = NULL;
    return STARG_OK;
}

/* Each face has two sides, 2 f and 2 f + 1; an edge connects a side to a side. */
static void join_sides(const mesh_topology *topology, const starg_mesh *mesh, uint32_t *parent) {
    for (uint32_t h = 0; h < 3 * (uint32_t)topology->face_count; h++) {
        uint32_t twin = topology->twin[h];
        if (twin == TOPOLOGY_NONE || twin < h)
            continue;
        uint32_t turned = mesh->faces[h] == mesh->faces[twin];
        sets_join(parent, 2 * (h / 3), 2 * (twin / 3) + turned);
        sets_join(parent, 2 * (h / 3) + 1, 2 * (twin / 3) + !turned);
    }
}

starg_status topology_count_one_sided(const mesh_topology *topology, const starg_mesh *mesh,
                                      size_t *count) {
    SCOPED uint32_t *parent = NULL;
    *count = 0;
    NEW(topology->context, "topology", parent, 2 * topology->face_count);
    sets_make(parent, 2 * topology->face_count);
    join_sides(topology, mesh, parent);
    for (uint32_t f = 0; f < topology->face_count; f++)
        *count += sets_find(parent, 2 * f) == sets_find(parent, 2 * f + 1);
    return STARG_OK;
}

void topology_free(mesh_topology *topology) {
    if (topology == NULL)
        return;
    RELEASE(topology->twin, topology->ring, topology->component, topology);
}

size_t topology_edge_faces(const mesh_topology *topology, uint32_t halfedge) {
    size_t count = 1;
    for (uint32_t h = topology->ring[halfedge]; h != halfedge; h = topology->ring[h])
        count++;
    return count;
}
