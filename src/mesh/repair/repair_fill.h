/* SPDX-License-Identifier: Apache-2.0 */
/* Triangulates a closed loop of vertices in space. */
#ifndef STARG_MESH_REPAIR_REPAIR_FILL_H
#define STARG_MESH_REPAIR_REPAIR_FILL_H

#include "mesh/repair/repair_index.h"

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

#endif
