/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether a surface encloses nothing, whatever its size. */
#ifndef STARG_TETRA_HOLLOW_H
#define STARG_TETRA_HOLLOW_H

#include "mesh/mesh.h"

/* *hollow is true if the mesh is planar, or if its faces cancel: on any three positions, equally
 * many have either orientation. Exact. Errors: MEMORY. */
starg_status tetra_is_hollow(starg_context *context, const starg_mesh *mesh, bool *hollow);

#endif
