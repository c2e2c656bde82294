/* SPDX-License-Identifier: Apache-2.0 */
/* Finds faces of the changing mesh that cross a triangle. */
#ifndef STARG_MESH_REPAIR_REPAIR_INDEX_H
#define STARG_MESH_REPAIR_REPAIR_INDEX_H

#include "geometry/bvh.h"
#include "mesh/repair/repair_state.h"

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

#endif
