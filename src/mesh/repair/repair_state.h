/* SPDX-License-Identifier: Apache-2.0 */
/* Working mesh of repair: an indexed face set that the stages change in place, and that records the
 * origin of its vertices and faces. It does not use mesh/halfedges.h, because edges may have any
 * number of faces in either direction until repair is done. */
#ifndef STARG_MESH_REPAIR_REPAIR_STATE_H
#define STARG_MESH_REPAIR_REPAIR_STATE_H

#include "core/memory.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "starguard/repair.h"

#define REPAIR_STAGE "repair"
#define REPAIR_NEW   UINT32_MAX /* origin of a vertex that is not in the input */

/* Flags of a face. */
enum {
    REPAIR_TURNED = 1, /* reversed relative to the input */
    REPAIR_ADDED = 2,  /* not in the input */
    REPAIR_GONE = 4    /* repair_compact removes it */
};

typedef struct repair_state {
    starg_context *context;
    const starg_mesh *input;
    starg_repair_options options;
    starg_repair_report report;
    size_t one_sided_faces; /* dropped because they cannot be oriented */
    STARG_ARRAY(double) vertices;
    STARG_ARRAY(uint32_t) origin; /* per vertex: its input vertex, or REPAIR_NEW */
    STARG_ARRAY(uint32_t) faces;
    STARG_ARRAY(uint8_t) flags; /* per face */
} repair_state;

static inline size_t repair_vertex_count(const repair_state *state) {
    return state->origin.count;
}

static inline size_t repair_face_count(const repair_state *state) {
    return state->flags.count;
}

static inline const double *repair_position(const repair_state *state, uint32_t vertex) {
    return state->vertices.data + 3 * (size_t)vertex;
}

static inline uint32_t *repair_face(const repair_state *state, size_t face) {
    return state->faces.data + 3 * face;
}

/* Starts with a copy of the input. Errors: MEMORY. */
starg_status repair_begin(repair_state *state, starg_context *context, const starg_mesh *input,
                          const starg_repair_options *options);
void repair_end(repair_state *state);

/* View of the working mesh: valid until vertices or faces are added. */
starg_mesh repair_view(const repair_state *state);

/* Diagonal of the input's bounding box. */
double repair_diagonal(const repair_state *state);

/* Are the three vertices collinear? Exact. */
bool repair_has_no_area(const repair_state *state, const uint32_t corner[3]);

/* Errors of both: MEMORY. */
starg_status repair_add_vertex(repair_state *state, const double p[3], uint32_t origin,
                               uint32_t *vertex);
starg_status repair_add_face(repair_state *state, uint32_t a, uint32_t b, uint32_t c,
                             uint8_t flags);

/* Reverses a face. */
void repair_turn(repair_state *state, size_t face);

/* Removes the faces marked REPAIR_GONE and keeps the order of the others. */
void repair_compact(repair_state *state);

/* Removes isolated vertices. Errors: MEMORY. */
starg_status repair_drop_isolated(repair_state *state);

/* The faces at each vertex: list[start[v]] to list[start[v + 1] - 1], ascending. */
typedef struct repair_stars {
    size_t *start;
    uint32_t *list;
} repair_stars;

starg_status repair_stars_create(const repair_state *state, repair_stars *stars);
void repair_stars_free(const repair_state *state, repair_stars *stars);

/* A set of 64-bit keys other than UINT64_MAX. */
typedef struct repair_keys {
    uint64_t *slots; /* key + 1, or 0 */
    size_t size, count;
} repair_keys;

starg_status repair_keys_add(starg_context *context, repair_keys *keys, uint64_t key);
bool repair_keys_have(const repair_keys *keys, uint64_t key);

/* The key of the edge between two vertices. */
static inline uint64_t repair_edge_key(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

#endif
