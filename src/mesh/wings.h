/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces that touch themselves in edges and vertices that they share. */
#ifndef STARG_MESH_WINGS_H
#define STARG_MESH_WINGS_H

#include "mesh/topology.h"

/* topology_create, with twins also at edges of more than two faces: those with solid between them.
 * Faces without a partner have none. Errors: MEMORY. */
starg_status wings_create(starg_context *context, const starg_mesh *mesh, mesh_topology **out);

/* Joins the corners at each vertex across twins: sets over corners, whose root is the lowest. */
void wings_find_fans(const mesh_topology *topology, const starg_mesh *mesh, uint32_t *fan);

/* A copy of the mesh in which each fan but the first at a vertex has a copy of the vertex, behind
 * the others. *out is NULL if all vertices have one fan. Errors: MEMORY, RANGE. */
starg_status wings_part(starg_context *context, const starg_mesh *mesh, starg_mesh **out);

#endif
