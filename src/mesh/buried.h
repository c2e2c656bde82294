/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices and faces that no free space touches where one would have to look from. */
#ifndef STARG_MESH_BURIED_H
#define STARG_MESH_BURIED_H

#include "mesh/solid.h"

/* True proves that no free space touches the vertex, so that nothing there is ever seen. False may
 * mean unknown: where other faces touch it, or a fold of its own ones does. */
bool solid_buries(const starg_solid *solid, uint32_t vertex);

/* True proves that the whole face is seen from nowhere: a corner of it is buried, or there is
 * matter right before the face beside one, as where furniture stands on a floor. */
bool solid_hides(const starg_solid *solid, uint32_t face);

#endif
