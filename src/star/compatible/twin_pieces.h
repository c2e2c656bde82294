/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces that are star-shaped in two solids: sets of tetrahedra that lie in two places. */
#ifndef STARG_STAR_COMPATIBLE_TWIN_PIECES_H
#define STARG_STAR_COMPATIBLE_TWIN_PIECES_H

#include "core/memory.h"
#include "core/rng.h"
#include "star/piece_faces.h"
#include "star/strict/start/region_growing.h"

#define TWIN_LAST UINT32_MAX /* ends a list */

/* Tetrahedra of a piece are a list: head, then next, to the tail. */
typedef struct twin_pieces {
    starg_context *context;
    const starg_tetmesh *meshes[2];
    starg_tetmesh *own[2]; /* the same, if they were divided; else NULL */
    grown_regions pieces;
    uint32_t *next;          /* per tetrahedron */
    uint32_t *heads, *tails; /* per piece; a piece that was joined to another has TWIN_LAST */
    uint8_t *fresh, *joined; /* per piece: changed in the last round of joins, in this one */
    face_corners faces;      /* of the pieces that are looked at */
} twin_pieces;

void twin_pieces_free(twin_pieces *w);
void twin_pieces_swap(twin_pieces *a, twin_pieces *b);

/* After meshes and labels are set: the lists. All pieces are fresh. Errors: MEMORY. */
starg_status twin_pieces_list(twin_pieces *w);

/* Joins neighbours of which one is fresh while unions have guards in both places, the largest
 * contact first, and numbers what is left without gaps. Errors: MEMORY, CANCELLED. */
starg_status twin_pieces_join(twin_pieces *w);

/* Moves every guard to the middle of its kernel. Errors: MEMORY, CANCELLED. */
starg_status twin_pieces_center(twin_pieces *w);

/* Are all pieces seen from their guards, in both places? Rounding of new vertices may spoil it.
 * Errors: MEMORY. */
starg_status twin_pieces_prove(twin_pieces *w, bool *proven);

/* Chooses `wanted` pieces that hang together, fewer if there are not so many, from a random one on:
 * dropped[piece] becomes 1. Says how many tetrahedra they have. Errors: MEMORY. */
starg_status twin_pieces_drop(const twin_pieces *w, size_t wanted, starg_rng *rng, uint8_t *dropped,
                              size_t *tetrahedra);

#endif
