/* SPDX-License-Identifier: Apache-2.0 */
/* The connectivity of a closed, oriented triangle mesh that changes: edges are collapsed, flipped
 * and split, faces are split. It stays a 2-manifold of the same topology. No operation looks at
 * coordinates; what vertices, edges and faces carry is the caller's. */
#ifndef STARG_MESH_HALFEDGES_H
#define STARG_MESH_HALFEDGES_H

#include <stdbool.h>

#include "core/memory.h"
#include "mesh/topology.h"

/* Corners, halfedges and faces are numbered as in topology.h and keep their numbers: a collapse
 * leaves gaps, a split appends. */
typedef struct mesh_halfedges {
    starg_context *context;
    const char *stage;             /* named in errors                                      */
    STARG_ARRAY(uint32_t) corners; /* of each face three vertices                          */
    STARG_ARRAY(uint32_t) twins;   /* of each halfedge; TOPOLOGY_NONE in a face that is gone */
    STARG_ARRAY(uint32_t)
    leaving; /* of each vertex a halfedge from it; TOPOLOGY_NONE for one
                without faces                                        */
} mesh_halfedges;

/* A copy of a mesh whose edges have two faces each, running opposite ways, and whose vertices have
 * one fan each. Errors: MEMORY. */
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

/* The corner across from a halfedge. */
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

/* The halfedges that leave v, in order from leaving[v] on; 0 when they are more than `most`. */
size_t halfedges_ring(const mesh_halfedges *m, uint32_t v, uint32_t *ring, size_t most);

/* The halfedge from v to w, or TOPOLOGY_NONE. */
uint32_t halfedges_find(const mesh_halfedges *m, uint32_t v, uint32_t w);

/* How many of the halfedges `a` end where one of `b` does: common neighbours, of two rings. */
size_t halfedges_common(const mesh_halfedges *m, const uint32_t *a, size_t a_count,
                        const uint32_t *b, size_t b_count);

/* Merges the end of h, which is then without faces, into its start. The edge satisfies the link
 * condition: its ends have no common neighbours but the two corners across from it, and the
 * component is no tetrahedron [Dey, Edelsbrunner, Guha, Nekhayev 1999]. */
void halfedges_collapse(mesh_halfedges *m, uint32_t h);

/* Faces u v w and v u x, with h from u to v, become w u x and x v w; w x is no edge before. */
void halfedges_flip(mesh_halfedges *m, uint32_t h);

/* Renumbers the halfedges of a face so that it begins with h; they leave its corners from now on.
 */
void halfedges_begin_face(mesh_halfedges *m, uint32_t h);

/* Puts a new vertex on the edge of h, or into a face. Errors: MEMORY; then nothing has changed but
 * that there may be a vertex without faces, or faces that do not live. */
starg_status halfedges_split_edge(mesh_halfedges *m, uint32_t h, uint32_t *vertex);
starg_status halfedges_split_face(mesh_halfedges *m, uint32_t face, uint32_t *vertex);

/* Numbers what is left: number[v] = place of v among the vertices with faces; the corners of the
 * living faces, in their order, go to `faces`, which has room for them. Returns the number of
 * vertices. */
uint32_t halfedges_compact(const mesh_halfedges *m, uint32_t *number, uint32_t *faces);

#endif
