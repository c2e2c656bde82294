/* SPDX-License-Identifier: Apache-2.0 */
/* On which tetrahedra does the visibility of a tetrahedron depend? */
#ifndef STARG_STAR_PAPER_DEPENDENCY_H
#define STARG_STAR_PAPER_DEPENDENCY_H

#include "star/paper/state.h"

/* The first tetrahedron, in the order of the mesh, whose closed hull holds p; PAPER_NONE outside.
 */
uint32_t dependency_home(const starg_tetmesh *mesh, const double p[3]);

/* The first tetrahedron around `vertex` into which the segment from there to p runs. */
uint32_t dependency_toward(const paper_state *s, uint32_t vertex, const double p[3]);

/* The tetrahedron that vertex k of a tetrahedron asks for when the latter is coloured, or
 * PAPER_NONE where it asks for none. The guard sees the vertex. */
uint32_t dependency_predecessor(const paper_state *s, const paper_guard *g, uint32_t tetrahedron,
                                int k);

/* Vertices of a tetrahedron that the guard sees, 0 to 4. */
int dependency_seen(const paper_state *s, const paper_guard *g, uint32_t tetrahedron);

#endif
