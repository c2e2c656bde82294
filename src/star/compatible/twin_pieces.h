/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces of two solids at once: the steps of compatible.c. */
#pragma once

#include "core/rng.h"
#include "star/certified/region_growing.h"
#include "star/piece_faces.h"

/* Pieces that are star-shaped in two solids: sets of tetrahedra that lie in two places. */

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
starg_status twin_pieces_prove(const twin_pieces *w, bool *proven);

/* Chooses `wanted` pieces that hang together, fewer if there are not so many, from a random one on:
 * dropped[piece] becomes 1. Says how many tetrahedra they have. Errors: MEMORY. */
starg_status twin_pieces_drop(const twin_pieces *w, size_t wanted, starg_rng *rng, uint8_t *dropped,
                              size_t *tetrahedra);

/* Cuts through compatible tetrahedra: the same surface in both places. */

/* Some tetrahedra of a mesh, and a level at each of their vertices: where it is 0, inside of
 * tetrahedra too, is the cut. What is below is part 0, what is above part 1. */
typedef struct through_cut {
    starg_context *context;
    const starg_tetmesh *meshes[2];
    const uint8_t *inside;          /* per tetrahedron: is it one of them? */
    double *levels;                 /* per vertex; 0 for those of no such tetrahedron */
    STARG_ARRAY(uint64_t) edges;    /* that cross the cut, ascending: lower vertex << 32 | upper */
    STARG_ARRAY(double) places[2];  /* of the vertices, and of the points where edges cross */
    STARG_ARRAY(uint32_t) faces[2]; /* around the parts */
} through_cut;

void through_free(through_cut *cut);

/* Moves the cut onto vertices that it passes near, and finds where it crosses edges. *found: there
 * is something on either side. Errors: MEMORY. */
starg_status through_place(through_cut *cut, bool *found);

/* The same, and guards of both parts in both places: guards[part][place]. *found: there are any.
 * Errors: MEMORY, CANCELLED. */
starg_status through_find(through_cut *cut, double guards[2][2][3], bool *found);

/* After either: divides the tetrahedra, and those beside them that have a common edge. `labels` has
 * one for each; those of the parts become THROUGH_PART + part. *good: all are positive in both
 * places, exactly; else there is no result. Errors: MEMORY, CANCELLED. */
#define THROUGH_PART (UINT32_MAX - 2)
starg_status through_divide(const through_cut *cut, const uint32_t *labels, starg_tetmesh *out[2],
                            uint32_t **out_labels, bool *good);

/* Cuts of compatible pieces: three and more become two. */

/* Divides tetrahedra, alike in both places and positive; every piece is proven afterwards. Errors:
 * MEMORY, CANCELLED. */
starg_status compatible_cut(twin_pieces *w);

/* Groups of compatible pieces, given up and grown anew. */

/* Never leaves more pieces than before. Errors: MEMORY, CANCELLED. */
starg_status compatible_regrow(twin_pieces *w);

/* Tetrahedra in two places, cut by planes into sets that are star-shaped in both. */

/* Divides the tetrahedra, alike in both places: `own` are the results, and `pieces` labels them.
 * Every set is strictly star-shaped in both, about its guard and its counterpart, proven by exact
 * signs. What no plane makes so is grown (region_growing.h). Each round draws other
 * planes. Errors: MESH (a tetrahedron so thin that no point is found in it), MEMORY, CANCELLED. */
starg_status compatible_planes(starg_context *context, const starg_tetmesh *const meshes[2],
                               uint64_t round, starg_tetmesh *own[2], grown_regions *pieces);
