/* SPDX-License-Identifier: Apache-2.0 */
/* The operations of repair, in the order in which starg_mesh_repair runs them. Each takes the mesh
 * as the ones before it have left it. Errors of all: MEMORY, CANCELLED. */
#ifndef STARG_MESH_REPAIR_REPAIR_H
#define STARG_MESH_REPAIR_REPAIR_H

#include "mesh/repair/repair_state.h"

/* Merges vertices at equal positions or within the merge distance. */
starg_status repair_weld(repair_state *state);

/* Drops faces that name a vertex twice. */
void repair_drop_repeated(repair_state *state);

/* Keeps one of several faces with the same corners, or none where the surface is closed without
 * them. Takes a mesh without repeated corners. */
starg_status repair_drop_duplicates(repair_state *state);

/* Drops open patches that hang from a surface by edges of an odd number of faces. */
starg_status repair_drop_fins(repair_state *state);

/* Makes faces on both sides of an edge run along it in opposite ways; drops what is one-sided. */
starg_status repair_orient(repair_state *state);

/* Cuts apart edges of more than two faces, and vertices of more than one fan. */
starg_status repair_split(repair_state *state);

/* Removes faces without area by flipping or collapsing an edge. Takes a manifold mesh. */
starg_status repair_degenerate(repair_state *state);

/* Fills the holes. Takes an oriented manifold mesh. */
starg_status repair_fill_holes(repair_state *state);

/* Drops components that enclose no volume. */
starg_status repair_drop_flat(repair_state *state);

/* Turns closed shells so that faces point out of the solid. */
starg_status repair_turn_shells(repair_state *state);

/* Resolves local intersections within a component. Takes a closed, oriented manifold mesh. */
starg_status repair_untangle(repair_state *state);

/* Makes the surface the boundary of what it encloses. Takes a closed surface whose shells are
 * turned; leaves edges and vertices for repair_split. */
starg_status repair_unite(repair_state *state);

#endif
