/* SPDX-License-Identifier: Apache-2.0 */
/* Star decompositions: their files, and the steps of decompose.c. */
#pragma once

#include "core/fields.h"
#include "guard/corners.h"
#include "starguard/decompose.h"
#include "visibility/kernel.h"

/* ---- the result of a star decomposition, whichever mode has found it (decomposition.c) ---- */

/* Words of starg_decompose_mode, by number; NULL behind the last. */
extern const char *const decompose_mode_words[];

/* Words of starg_balls, likewise. */
extern const char *const decompose_ball_words[];

/* starg_decompose_options in PIECES.json. */
extern const starg_fields decompose_file_options;

/* PIECES.json as a starg_decomposition. */
extern const starg_fields decomposition_file_fields;

/* Makes a result of labels: `guards` is count x 3, `labels` (a block of the context) has one of 0
 * to count - 1 for each tetrahedron, each of them at least once. Counts and measures the pieces,
 * proves which are star-shaped, finds their contacts and what guards see. The mesh counts as the
 * model and its surface as kept until the caller knows better. Mesh and labels are taken over, also
 * on failure. Errors: MEMORY, CANCELLED. */
starg_status decomposition_finish(starg_context *context, starg_decompose_mode mode,
                                  starg_tetmesh *mesh, int32_t *labels, const double *guards,
                                  size_t count, starg_decomposition **out);

/* Fills visible_vertices; the pieces are known. Errors: MEMORY, CANCELLED. */
starg_status decomposition_find_sight(starg_context *context, starg_decomposition *d);

/* ---- maps of star-shaped pieces to balls (balls.c) ---- */

/* Fills what a decomposition holds of its maps to balls. Its pieces are star-shaped, and made of
 * tetrahedra about their guards. Errors: SOLVER, MEMORY, CANCELLED. */
starg_status balls_make(starg_context *context, starg_decomposition *d, starg_balls kind);

/* ---- surfaces that touch themselves (touching.c) ---- */

/* The faces of a solid with one vertex at each position (free with starg_release), or NULL when
 * these intersect, lie on one another, have no area, or touch otherwise than in common vertices and
 * edges. Errors: MEMORY, CANCELLED. */
starg_status touching_weld(starg_context *context, const starg_solid *solid, uint32_t **faces);

/* Does the surface have the outside just before every point of its faces, as an embedded one does?
 * If it touches itself, that is known where touching_weld has a result. Errors: MEMORY, CANCELLED.
 */
starg_status touching_bounds(starg_context *context, const starg_solid *solid, bool *bounds);

/* ---- how far one surface is from another (deviation.c) ---- */

/* No point of `from` is farther than *out from the triangles of `to`, of which there are some; that
 * is too much by no more than the larger of its half and rounding, nor than the step. `extent` is
 * the size of the model. Errors: MEMORY, CANCELLED. */
starg_status deviation_bound(starg_context *context, const starg_mesh *from, const bvh *to,
                             double extent, double step, double *out)
    STARG_PRIVATE(deviation_bound);

/* ---- the solid that a surface encloses which intersects itself (united.c) ---- */

/* The solid bounded by the union. *out is NULL where the surface neither touches nor intersects
 * itself and has no degenerate face, or, with a notice, where it cannot be cut at its
 * intersections. Errors: MEMORY, CANCELLED, TIME. */
starg_status united_make(starg_context *context, const starg_solid *solid, starg_solid **out);

/* The solid bounded by a surface with open edges, where these close once its faces share what they
 * touch; else *out is NULL. *exact: nothing has moved. Errors: MEMORY, CANCELLED, TIME. */
starg_status united_join(starg_context *context, const starg_mesh *surface, starg_solid **out,
                         bool *exact);

/* The solid bounded by a surface whose vertices nearer than `distance`, over the diagonal, are one.
 * *out is NULL if there are none, or it bounds none then. Errors: MEMORY, CANCELLED, TIME. */
starg_status united_merge(starg_context *context, const starg_mesh *surface, double distance,
                          starg_solid **out);

/* Tells in `out`, pieces of the union, which faces of the model are kept, and how far the rest is
 * from the boundary. Errors: MEMORY, CANCELLED. */
starg_status united_report(starg_context *context, const starg_mesh *model,
                           const starg_solid *united, starg_decomposition *out);

/* ---- star decomposition by growth from guards [YL11, section 4] (paper/paper.c) ---- */

/* Labels the tetrahedra of a copy of the mesh, whose inner vertices move a little where pieces
 * meet. Errors: MEMORY, CANCELLED. */
starg_status paper_decompose(starg_context *context, const starg_tetmesh *mesh,
                             const starg_decompose_options *options, starg_decomposition **out);

/* ---- strict decomposition: every piece is proven star-shaped (certified/certified.c) ---- */

/* From the surface alone, which faces outward and meets itself in common vertices and edges at
 * most, and what is known of its parts, which are cut one by one. *out is NULL when roundings have
 * spoilt all cuts of some piece. Errors: MEMORY, CANCELLED.
 */
starg_status certified_decompose_surface(starg_context *context, const kernel_faces *surface,
                                         const solid_parts *parts,
                                         const starg_decompose_options *options,
                                         starg_decomposition **out);

/* From the boundary of tetrahedra, or from tetrahedra grown into regions where that resists.
 * Errors: MESH (a tetrahedron too thin to contain a point), MEMORY, CANCELLED. */
starg_status certified_decompose_tetmesh(starg_context *context, const starg_tetmesh *mesh,
                                         const starg_decompose_options *options,
                                         starg_decomposition **out);

STARG_DROP_RESULT(starg_decomposition)
