/* SPDX-License-Identifier: Apache-2.0 */
/* Repair stages, in the order of starg_mesh_repair. Each works on the result of the stages before
 * it. Errors of all: MEMORY, CANCELLED. */
#ifndef STARG_MESH_REPAIR_REPAIR_H
#define STARG_MESH_REPAIR_REPAIR_H

#include "mesh/repair/repair_state.h"

/* Merges vertices at equal positions or within the merge distance. */
starg_status repair_weld(repair_state *state);

/* Drops faces that use a vertex twice. */
void repair_drop_repeated(repair_state *state);

/* Keeps one of several faces with the same corners, or none if the surface is closed without them.
 * Requires a mesh without repeated corners. */
starg_status repair_drop_duplicates(repair_state *state);

/* Drops open patches attached to a surface by edges with an odd number of faces. */
starg_status repair_drop_fins(repair_state *state);

/* Orients patches consistently; drops one-sided ones. */
starg_status repair_orient(repair_state *state);

/* Splits edges with more than two faces, and vertices with more than one fan. */
starg_status repair_split(repair_state *state);

/* Removes zero-area faces by edge flips or collapses. Requires a manifold mesh. */
starg_status repair_degenerate(repair_state *state);

/* Fills holes. Requires an oriented manifold mesh. */
starg_status repair_fill_holes(repair_state *state);

/* Drops components that enclose no volume. */
starg_status repair_drop_flat(repair_state *state);

/* Reverses closed shells where necessary so that faces point out of the solid. */
starg_status repair_turn_shells(repair_state *state);

/* Resolves local intersections within a component. Requires a closed, oriented manifold mesh. */
starg_status repair_untangle(repair_state *state);

/* Replaces the surface by the boundary of what it encloses. Requires a closed surface with oriented
 * shells; leaves non-manifold edges and vertices to repair_split. */
starg_status repair_unite(repair_state *state);

#endif
