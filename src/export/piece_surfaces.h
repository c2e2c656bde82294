/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces of pieces of tetrahedra, for drawing. */
#pragma once

#include "core/context.h"
#include "starguard/verify.h"

typedef struct starg_piece_surfaces {
    size_t piece_count;
    size_t *first_face; /* piece_count + 1: the faces of each piece are contiguous */
    uint32_t *faces;    /* three each, outward from the piece; indices into `vertices` */
    size_t vertex_count;
    uint32_t *vertices; /* vertices in use, ascending; indices into those of the tetrahedra */
} starg_piece_surfaces;

/* Errors: ARGUMENT (an index or a label out of range), MEMORY, CANCELLED. */
starg_status starg_piece_surfaces_create(starg_context *context, const starg_pieces_mesh *mesh,
                                         starg_piece_surfaces *out);
void starg_piece_surfaces_free(starg_piece_surfaces *surfaces);
