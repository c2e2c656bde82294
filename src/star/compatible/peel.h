/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of pieces that keep one of their two places star-shaped (peel.c), and walls of these that
 * span two loops of the same length at once (web.c). */
#pragma once

#include "star/compatible/cone_builder.h"

/* PEEL_BROKEN: the leaf is off, but no wall fits; the pieces are of no use any more. */
typedef enum peel_verdict { PEEL_DONE, PEEL_NOTHING, PEEL_BROKEN } peel_verdict;

/* Cuts a piece that has no kernel in the place `end`. A kernel in the other place is kept in what
 * is left and in all that is taken off. PEEL_NOTHING: no cut was found. Errors: MEMORY, CANCELLED.
 */
starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out)
    STARG_PRIVATE(cones_peel);

/* Triangles that span a loop. Corners below `count` are the loop's nodes, those from there on the
 * points of a ring inside. */
typedef struct cone_web {
    size_t count;
    STARG_ARRAY(double) ring; /* x 3: unit directions, one for each node */
    number_list triangles;    /* x 3: to the left of the loop, passed as the loop is */
} cone_web;

/* Spans a loop that is given by the directions of its nodes. *found: there is a web; false where
 * the loop passes itself or goes round most of the sphere. Errors: MEMORY. */
starg_status cones_find_web(starg_context *context, const double *directions, size_t count,
                            cone_web *out, bool *found) STARG_PRIVATE(cones_find_web);
void cones_free_web(cone_web *web) STARG_PRIVATE(cones_free_web);
