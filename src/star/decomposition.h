/* SPDX-License-Identifier: Apache-2.0 */
/* The result of a star decomposition, whichever mode has found it. */
#ifndef STARG_STAR_DECOMPOSITION_H
#define STARG_STAR_DECOMPOSITION_H

#include "core/fields.h"
#include "starguard/decompose.h"

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

#endif
