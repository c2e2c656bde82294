/* SPDX-License-Identifier: Apache-2.0 */
/* Connectivity of a closed, oriented triangle mesh under edge collapses, flips and splits and face
 * splits. It stays a 2-manifold of the same topology. No operation reads coordinates; attributes of
 * vertices, edges and faces belong to the caller. */
#pragma once

#include "mesh/topology.h"

/* Corners, halfedges and faces are numbered as in topology.h. Numbers are stable: a collapse leaves
 * gaps, a split appends. */
typedef struct mesh_halfedges {
    starg_context *context;
    const char *stage;             /* named in errors */
    STARG_ARRAY(uint32_t) corners; /* three vertices per face */
    STARG_ARRAY(uint32_t) twins;   /* per halfedge; TOPOLOGY_NONE in a removed face */
    STARG_ARRAY(uint32_t)
    leaving; /* per vertex a halfedge that starts there; TOPOLOGY_NONE without faces */
} mesh_halfedges;

/* Copies a mesh in which every edge has two faces of opposite directions and every vertex one fan.
 * Errors: MEMORY. */
starg_status halfedges_create(const mesh_topology *topology, const starg_mesh *mesh,
                              const char *stage, mesh_halfedges *out);
/* Errors: MEMORY. */
starg_status halfedges_copy(const mesh_halfedges *m, mesh_halfedges *out);
void halfedges_free(mesh_halfedges *m);

static inline bool halfedges_face_lives(const mesh_halfedges *m, size_t face) {
    return m->twins.data[3 * face] != TOPOLOGY_NONE;
}

static inline uint32_t halfedges_start(const mesh_halfedges *m, uint32_t h) {
    return m->corners.data[h];
}

static inline uint32_t halfedges_end(const mesh_halfedges *m, uint32_t h) {
    return m->corners.data[corner_next(h)];
}

/* The corner opposite to a halfedge. */
static inline uint32_t halfedges_apex(const mesh_halfedges *m, uint32_t h) {
    return m->corners.data[corner_previous(h)];
}

static inline uint32_t halfedges_twin(const mesh_halfedges *m, uint32_t h) {
    return m->twins.data[h];
}

/* The next halfedge from the same vertex, counter-clockwise seen from outside. */
static inline uint32_t halfedges_turn(const mesh_halfedges *m, uint32_t h) {
    return m->twins.data[corner_previous(h)];
}

/* The halfedges from v, in order, starting with leaving[v]; returns 0 if there are more than
 * `most`. */
size_t halfedges_ring(const mesh_halfedges *m, uint32_t v, uint32_t *ring, size_t most);

/* The halfedge from v to w, or TOPOLOGY_NONE. */
uint32_t halfedges_find(const mesh_halfedges *m, uint32_t v, uint32_t w);

/* Number of halfedges of `a` that end where one of `b` ends: the common neighbours of two rings. */
size_t halfedges_common(const mesh_halfedges *m, const uint32_t *a, size_t a_count,
                        const uint32_t *b, size_t b_count);

/* Merges the end of h, which then has no faces, into its start. The edge must satisfy the link
 * condition: its ends have no common neighbours besides the two opposite corners, and the component
 * is not a tetrahedron [Dey, Edelsbrunner, Guha, Nekhayev 1999]. */
void halfedges_collapse(mesh_halfedges *m, uint32_t h);

/* Faces u v w and v u x, with h from u to v, become w u x and x v w; w x must not be an edge. */
void halfedges_flip(mesh_halfedges *m, uint32_t h);

/* Renumbers the halfedges of a face so that it starts with h; they become the `leaving` ones of its
 * corners. */
void halfedges_begin_face(mesh_halfedges *m, uint32_t h);

/* Inserts a vertex into the edge of h, or into a face. Errors: MEMORY; the mesh is then unchanged
 * except for an isolated vertex or dead faces. */
starg_status halfedges_split_edge(mesh_halfedges *m, uint32_t h, uint32_t *vertex);
starg_status halfedges_split_face(mesh_halfedges *m, uint32_t face, uint32_t *vertex);

/* Renumbers the remaining mesh: number[v] = index of v among the vertices with faces; `faces`,
 * allocated by the caller, receives the corners of the living faces in order. Returns the number of
 * vertices. */
uint32_t halfedges_compact(const mesh_halfedges *m, uint32_t *number, uint32_t *faces);
