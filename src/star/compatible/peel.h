/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of pieces that keep one of their two places star-shaped. */
#pragma once

#include "star/compatible/cone_builder.h"

/* PEEL_BROKEN: the leaf is off, but no wall fits; the pieces are of no use any more. */
typedef enum peel_verdict { PEEL_DONE, PEEL_NOTHING, PEEL_BROKEN } peel_verdict;

/* Cuts a piece that has no kernel in the place `end`, or in b->first_end if it has none in either.
 * A kernel in the other place is kept in what is left and in all that is taken off. PEEL_NOTHING:
 * no cut was found. Errors: MEMORY, CANCELLED. */
starg_status cones_peel(cone_builder *b, uint32_t which, int end, peel_verdict *out)
    STARG_PRIVATE(cones_peel);
