/* SPDX-License-Identifier: Apache-2.0 */
/* Tetrahedra that fill both ends of a morph. */
#pragma once

#include "morph/deform.h"

/* Initial tetrahedra per vertex, unless others are asked for. */
#define SOLIDS_DENSITY 1.0

/* The vertices of A in use, in order, are the first of the tetrahedra: c->fixed and c->surface.
 * *surface is the caller's, also on failure. Errors: MEMORY. */
starg_status solids_list_surface(const starg_mesh *a, deform_mesh *c, uint32_t **surface);

/* Checks that both ends bound a solid without self-intersections, and fills A with tetrahedra that
 * keep its surface. `c` is empty but for its context; *surface, to which it refers, and *solid are
 * the caller's, also on failure. Errors: MESH, SOLVER (no TetGen), MEMORY, CANCELLED. */
starg_status solids_fill(const starg_morph *m, double density, deform_mesh *c, starg_solid **solid,
                         uint32_t **surface);

/* The same for A alone: B in A's connectivity may meet itself. */
starg_status solids_fill_first(const starg_morph *m, double density, deform_mesh *c,
                               starg_solid **solid, uint32_t **surface);

/* Is the last end no solid without self-intersections? Errors: MEMORY. */
starg_status solids_last_meets_itself(const starg_morph *m, bool *out);

/* Checks that the last end bounds a solid without self-intersections. Errors: MESH, MEMORY. */
starg_status solids_check_last(const starg_morph *m);

/* Checks that no faces of a surface pass through one another; `what` it is called. Errors: MESH,
 * MEMORY. */
starg_status solids_check_crossings(starg_context *context, const starg_mesh *mesh,
                                    const char *what);

/* Divides the tetrahedra of A so that their surface is an overlay: its vertices come first, in its
 * order, and c->surface is the caller's to set (solid_overlay.c). Errors: MESH (parts of A too thin
 * for doubles), MEMORY. */
starg_status solids_divide(deform_mesh *c, const starg_mesh *a, const starg_overlay *overlay);

/* One of the two places of tetrahedra that are known not to overlap: a copy. Errors: MEMORY. */
starg_status solids_place(const deform_mesh *c, const double *places, starg_tetmesh **out);
