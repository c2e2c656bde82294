/* Inside of a solid: what the later stages read. */
#ifndef STARG_MESH_SOLID_H
#define STARG_MESH_SOLID_H

#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "starguard/solid.h"

struct starg_solid {
    starg_context *context;
    starg_mesh *mesh; /* every shell faces out of the solid */
    starg_check *check;
    bvh *tree;
};

#endif
