/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of faces that may meet. */
#ifndef STARG_MESH_PAIRS_H
#define STARG_MESH_PAIRS_H

#include "geometry/bvh.h"
#include "mesh/mesh.h"

/* Calls visit(a, b) at most once for each unordered pair of faces, for all pairs that have a point
 * in common beside a common corner, and some others; false ends the visit. `tree` is that of the
 * mesh. Errors: MEMORY. */
starg_status face_pairs_visit(starg_context *context, const starg_mesh *mesh, const bvh *tree,
                              bvh_visit_pair *visit, void *user);

#endif
