/* SPDX-License-Identifier: Apache-2.0 */
/* Triangulating a closed loop of vertices in space. */
#ifndef STARG_MESH_REPAIR_REPAIR_FILL_H
#define STARG_MESH_REPAIR_REPAIR_FILL_H

#include "mesh/repair/repair_index.h"

typedef STARG_ARRAY(uint32_t) fill_list;

/* What a filling has to respect. */
typedef struct fill_job {
    const repair_state *state;
    const repair_index *index;                               /* faces that it should not cross   */
    bool (*taken)(const void *user, uint32_t a, uint32_t b); /* is there such an edge already? */
    const void *user;
} fill_job;

/* Appends count - 2 triangles, three entries each, that run along the loop. *faults is the number
 * of them that cross something or have no area; *possible is false (and nothing appended) when
 * every triangulation needs an edge that is there already. Errors: MEMORY. */
starg_status repair_fill(const fill_job *job, const uint32_t *loop, size_t count,
                         fill_list *triangles, size_t *faults, bool *possible);

#endif
