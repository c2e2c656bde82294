/* SPDX-License-Identifier: Apache-2.0 */
/* The check and the tables that it was computed from, for callers that need both. */
#ifndef STARG_MESH_EXAMINE_H
#define STARG_MESH_EXAMINE_H

#include "geometry/bvh.h"
#include "mesh/shells.h"
#include "mesh/topology.h"
#include "starguard/check.h"

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
void mesh_examination_free(starg_context *context, mesh_examination *examination);

#endif
