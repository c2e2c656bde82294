/* SPDX-License-Identifier: Apache-2.0 */
/* The check and the tables that it was computed from, for callers that need both. */
#pragma once

#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "starguard/check.h"

/* ---- nesting of closed shells, and which of them must be reversed (shells.c) ---- */
/* So that all faces point out of the solid. */

typedef struct mesh_shell {
    uint32_t first_face;
    double volume;   /* signed, as given, times 8^-starg_mesh_exponent */
    size_t depth;    /* the number of other shells that it lies in */
    uint32_t within; /* of a cavity: the innermost shell around it; else UINT32_MAX */
    int around;      /* winding number of the other shells about it, as given */
    bool crossed;    /* intersects other shells; set by the caller where faces cross */
    bool cavity;     /* bounds a hole: it lies in an odd number of other shells */
    bool turn;       /* faces must be reversed */
} mesh_shell;

/* Fills all but crossed of topology->component_count shells of a closed, oriented
 * mesh. A shell inside an even number of others bounds the solid from outside (positive volume),
 * inside an odd number a cavity (negative). Nesting is undefined where shells intersect; those all
 * get positive volume. `touching` marks the faces that meet other shells. Errors: MEMORY,
 * CANCELLED, TIME. */
starg_status shells_classify(starg_context *context, const starg_mesh *mesh,
                             const mesh_topology *topology, const bvh *tree,
                             const uint8_t *touching, mesh_shell *shells);

/* ---- pairs of faces that may meet (pairs.c) ---- */

/* Calls visit(a, b) at most once for each unordered pair of faces, for all pairs that have a point
 * in common beside a common corner, and some others; false ends the visit. `tree` is that of the
 * mesh. Unless `matters` is NULL, pairs for which it is false may be left out; it is called on all
 * threads. Errors: MEMORY, CANCELLED, TIME. */
starg_status face_pairs_visit(starg_context *context, const starg_mesh *mesh, const bvh *tree,
                              bvh_visit_pair *matters, bvh_visit_pair *visit, void *user);

typedef struct mesh_examination {
    starg_check *check;
    mesh_topology *topology;
    bvh *tree;          /* borrows the mesh's arrays */
    mesh_shell *shells; /* topology->component_count; classified only if closed and consistent */
} mesh_examination;

/* Examines a mesh; release with mesh_examination_free, whatever the status. */
starg_status mesh_examine(starg_context *context, const starg_mesh *mesh, mesh_examination *out);
/* For each vertex the first vertex at its position; `count` is the number of vertices that are not
 * the first. Release with starg_release, whatever the status. Errors: MEMORY. */
starg_status mesh_find_coincident(starg_context *context, const starg_mesh *mesh, uint32_t **first,
                                  size_t *count);
/* Does no face lack area, or intersect another? Parts may then share vertices and edges. */
bool mesh_only_touches(const starg_check *check);
/* Has rounding far from the origin broken it? Then nothing else is worth saying. */
bool mesh_is_rounded(const starg_check *check);
void mesh_examination_free(mesh_examination *examination);

STARG_DROP_RESULT(starg_check)

/* ---- the grid on which coordinates lie (grid.c) ---- */

/* Sets the grid, by axis the largest power of two or of ten of which all coordinates are multiples
 * (0 if all are 0), the shortest edge, and whether the grid is coarse for edges as short, as
 * rounding far from the origin leaves it. */
void check_steps(const starg_mesh *mesh, starg_check *check);
