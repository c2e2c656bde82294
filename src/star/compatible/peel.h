/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of pieces that keep one of their two places star-shaped: their choice (peel.c), and leaves
 * in layers (layers.c). */
#pragma once

#include "star/compatible/cone_builder.h"

/* PEEL_BROKEN: the leaf is off, but no wall fits; the pieces are of no use any more. */
typedef enum peel_verdict { PEEL_DONE, PEEL_NOTHING, PEEL_BROKEN } peel_verdict;

/* Cuts a piece that has no kernel in the place `end`, or in b->first_end if it has none in either.
 * A kernel in the other place is kept in what is left and in all that is taken off. PEEL_NOTHING:
 * no cut was found. Errors: MEMORY, CANCELLED. */
starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out)
    STARG_PRIVATE(cones_peel);

/* A leaf that has its part of a piece's surface, but no wall yet. */
typedef struct cone_leaf {
    cone_builder *b;
    uint32_t which, leaf;    /* what is left, and the leaf */
    int end;                 /* the place of the plane */
    const double *g;         /* in the other one sees all of the piece */
    const cut_loops *rim;    /* one loop, around the leaf */
    const loop_places *wall; /* its place in the plane */
} cone_leaf;

/* Gives a leaf its wall, and divides it into layers. *done: all points that takes were found; else
 * the pieces are of no use any more. Errors: MEMORY. */
starg_status cones_lay(const cone_leaf *leaf, bool *done) STARG_PRIVATE(cones_lay);

/* The point with the most room below the planes of faces, its room as a share of their size, the
 * root of their area, and how much of that it sees. */
typedef struct side_view {
    double point[3], room, area, seen;
} side_view;

/* Faces of a piece (corners, x 3), seen from the side of a flat wall on which a vertex lies, or
 * from beyond. Errors: MEMORY. */
starg_status cones_see_side(const cone_builder *b, int end, const number_list *faces,
                            const loop_places *wall, uint32_t vertex, bool beyond, side_view *out)
    STARG_PRIVATE(cones_see_side);
