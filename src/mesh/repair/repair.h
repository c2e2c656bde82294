/* SPDX-License-Identifier: Apache-2.0 */
/* Repair stages, in the order of starg_mesh_repair. Each works on the result of the stages before
 * it. Errors of all: MEMORY, CANCELLED. */
#pragma once

#include "geometry/bvh.h"
#include "mesh/topology.h"
#include "starguard/repair.h"

/* ---- working mesh: an indexed face set with the origin of its elements (repair_state.c) ---- */
/* The stages change it in place. It does not use mesh/halfedges.h, because edges may have any
 * number of faces in either direction until repair is done. */

#define REPAIR_STAGE "repair"
#define REPAIR_NEW   UINT32_MAX /* origin of a vertex that is not in the input */

/* Flags of a face. */
enum {
    REPAIR_TURNED = 1, /* reversed relative to the input */
    REPAIR_ADDED = 2,  /* not in the input */
    REPAIR_GONE = 4,   /* repair_compact removes it */
    REPAIR_FILLED = 8  /* fills a hole */
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
void repair_stars_free(repair_stars *stars);

/* A set of 64-bit keys other than UINT64_MAX. */
typedef struct repair_keys {
    uint64_t *slots; /* key + 1, or 0 */
    size_t size, count;
} repair_keys;

starg_status repair_keys_add(starg_context *context, repair_keys *keys, uint64_t key);
bool repair_keys_have(const repair_keys *keys, uint64_t key);

/* ---- faces of the changing mesh that cross a triangle (repair_index.c) ---- */

/* A tree over a copy of the faces. Changed faces must be marked REPAIR_GONE and added again; faces
 * added later are tested one by one. */
typedef struct repair_index {
    const repair_state *state;
    size_t tracked; /* faces in the tree */
    double *vertices;
    uint32_t *faces;
    bvh *tree;
} repair_index;

/* Errors: MEMORY. */
starg_status repair_index_create(const repair_state *state, repair_index *index);
void repair_index_free(repair_index *index);

/* Have enough faces been added for a rebuild to pay off? */
bool repair_index_is_stale(const repair_index *index);

/* Calls visit for every existing face that crosses the triangle, except itself, until it returns
 * false. */
void repair_index_query(const repair_index *index, const uint32_t corner[3], bvh_visit *visit,
                        void *user);

/* Does the triangle cross any existing face? */
bool repair_index_crosses(const repair_index *index, const uint32_t corner[3]);

/* ---- triangles for a closed loop of vertices in space (repair_fill.c) ---- */

typedef STARG_ARRAY(uint32_t) fill_list;

/* Constraints on a filling. */
typedef struct fill_job {
    const repair_state *state;
    const repair_index *index;                               /* faces to avoid */
    bool (*taken)(const void *user, uint32_t a, uint32_t b); /* does the edge exist already? */
    const void *user;
} fill_job;

/* Appends count - 2 triangles, three entries each, oriented along the loop. *faults is the number
 * of them that cross something or have no area; *possible is false (and nothing is appended) if
 * every triangulation uses an existing edge. Errors: MEMORY. */
starg_status repair_fill(const fill_job *job, const uint32_t *loop, size_t count,
                         fill_list *triangles, size_t *faults, bool *possible);

/* Makes shared what touches, within rounding or the merge distance: vertices, edges, faces in one
 * plane. */
starg_status repair_conform(repair_state *state);

/* A merge distance, as a fraction of the diagonal, that leaves the input without open edges; 0 if
 * none is found, or the mesh is large. Errors: MEMORY, CANCELLED, TIME. */
starg_status repair_suggest(const repair_state *state, double *distance);

/* The sum over parts connected by edges of the volume that each encloses, in whatever way it is
 * turned; *closed is false if there are edges that bound more faces of one direction than of the
 * other. Errors: MEMORY. */
starg_status repair_measure(const repair_state *state, bool *closed, double *enclosed);

/* Replaces the surface by the boundary of what it encloses. Requires a closed surface with oriented
 * shells; leaves edges of more faces, and vertices of several fans, to repair_split. */
starg_status repair_unite(repair_state *state);

/* Drops faces that use a vertex twice. */
void repair_drop_repeated(repair_state *state);

/* Keeps one of several faces with the same corners, or none if the surface is closed without them.
 * Requires a mesh without repeated corners. */
starg_status repair_drop_duplicates(repair_state *state);

/* Drops open patches attached to a surface by edges with an odd number of faces. */
starg_status repair_drop_fins(repair_state *state);

/* Orients patches consistently; drops one-sided ones. */
starg_status repair_orient(repair_state *state);

/* Splits edges with more than two faces, and vertices with more than one fan. */
starg_status repair_split(repair_state *state);

/* Removes zero-area faces by edge flips or collapses. Requires a manifold mesh. */
starg_status repair_degenerate(repair_state *state);

/* Fills holes. Requires an oriented manifold mesh. */
starg_status repair_fill_holes(repair_state *state);

/* Drops components that enclose no volume. */
starg_status repair_drop_flat(repair_state *state);

/* Reverses closed shells where necessary so that faces point out of the solid; not what was an open
 * sheet, closed by faces of a good part of its area. */
starg_status repair_turn_shells(repair_state *state);

/* Resolves local intersections within a component. Requires a closed, oriented manifold mesh. */
starg_status repair_untangle(repair_state *state);
