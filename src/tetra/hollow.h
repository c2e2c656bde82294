/* SPDX-License-Identifier: Apache-2.0 */
/* Does a surface enclose nothing at all, whatever its size? */
#ifndef STARG_TETRA_HOLLOW_H
#define STARG_TETRA_HOLLOW_H

#include "mesh/mesh.h"

/* *hollow is true when the mesh lies in a plane, or when its faces cancel: as many lie one way
 * round as the other on any three positions. Exact. Errors: MEMORY. */
starg_status tetra_is_hollow(starg_context *context, const starg_mesh *mesh, bool *hollow);

#endif
