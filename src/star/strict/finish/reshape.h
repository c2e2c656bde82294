/* SPDX-License-Identifier: Apache-2.0 */
/* Better tetrahedra by small changes of a finished partition. */
#ifndef STARG_STAR_STRICT_FINISH_RESHAPE_H
#define STARG_STAR_STRICT_FINISH_RESHAPE_H

#include "star/strict/partition/partition.h"

/* Moves guards and vertices that cuts have made, merges such vertices with others, and swaps edges,
 * where angles lack less then (star/strict/finish/flatness.c). No margin gets smaller unless it
 * stays above half of FLATNESS_MARGIN. Ends when `work` (64 for each look at a facet) is done or
 * time is over. Rebuilds the index. Errors: MEMORY, CANCELLED. */
starg_status reshape(partition *p, uint64_t work);

#endif
