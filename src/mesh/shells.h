/* SPDX-License-Identifier: Apache-2.0 */
/* Nesting of the closed shells of a mesh, and which of them must be reversed so that all faces
 * point out of the solid. */
#ifndef STARG_MESH_SHELLS_H
#define STARG_MESH_SHELLS_H

#include <stdbool.h>

#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

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

#endif
