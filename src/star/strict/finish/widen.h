/* SPDX-License-Identifier: Apache-2.0 */
/* Room for the guards of a partition. */
#ifndef STARG_STAR_STRICT_FINISH_WIDEN_H
#define STARG_STAR_STRICT_FINISH_WIDEN_H

#include "star/strict/partition/partition.h"

/* Cuts pairs of neighbours anew, so that the smallest balls in
 * kernels and the smallest angles grow; `work` bounds the vertices, facets and rows visited. Stops
 * when time runs out. Errors: MEMORY, CANCELLED. */
starg_status widen(partition *p, uint64_t work);

#endif
