/* SPDX-License-Identifier: Apache-2.0 */
/* Which faces of the working mesh a triangle crosses, while the mesh changes. */
#ifndef STARG_MESH_REPAIR_REPAIR_INDEX_H
#define STARG_MESH_REPAIR_REPAIR_INDEX_H

#include "geometry/bvh.h"
#include "mesh/repair/repair_state.h"

/* A tree over the faces as they were, with arrays of its own. Faces that change must be marked
 * REPAIR_GONE and added anew; those added later are tried one by one. */
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

/* Have so many faces been added that building it again pays? */
bool repair_index_is_stale(const repair_index *index);

/* Calls visit for every face that is there and crosses the triangle, except itself, until it
 * returns false. */
void repair_index_query(const repair_index *index, const uint32_t corner[3], bvh_visit *visit,
                        void *user);

/* Does the triangle cross any face that is there? */
bool repair_index_crosses(const repair_index *index, const uint32_t corner[3]);

#endif
