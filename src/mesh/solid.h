/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of a solid: what the later stages read. */
#ifndef STARG_MESH_SOLID_H
#define STARG_MESH_SOLID_H

#include "core/private.h"
#include "geometry/bvh.h"
#include "mesh/mesh.h"
#include "starguard/solid.h"

struct starg_solid {
    starg_context *context;
    starg_mesh *mesh; /* every shell faces out of the solid */
    starg_check *check;
    bvh *tree;
};

/* Logs what is wrong with the surface of a solid. It names faces of the mesh that was given: for
 * the user's own, which `whose` may introduce ("A: "). */
void solid_tell(starg_context *context, const char *whose, const starg_check *check)
    STARG_PRIVATE(solid_tell);

/* starg_solid_create for steps of a longer work, in which nothing is logged; in the first the time
 * limit does not end it. */
starg_status solid_make(starg_context *context, const starg_mesh *mesh, starg_solid **out)
    STARG_PRIVATE(solid_make);
starg_status solid_make_in_time(starg_context *context, const starg_mesh *mesh, starg_solid **out)
    STARG_PRIVATE(solid_make_in_time);

/* The solid that another process has examined: its mesh as it was after that, and as much of the
 * check as is needed. Copies all. Errors: those of starg_mesh_create. */
starg_status solid_of_parts(starg_context *context, const double *vertices, size_t vertex_count,
                            const uint32_t *faces, size_t face_count, const starg_check *check,
                            starg_solid **out);

#endif
