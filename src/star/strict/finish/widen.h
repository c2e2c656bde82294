/* SPDX-License-Identifier: Apache-2.0 */
/* Room for the guards of a partition. */
#ifndef STARG_STAR_STRICT_FINISH_WIDEN_H
#define STARG_STAR_STRICT_FINISH_WIDEN_H

#include "star/strict/partition/partition.h"

/* Cuts unions of neighbours anew, as many pieces as before, so that the smallest balls in kernels
 * get larger; `work` bounds the vertices, facets and rows looked at. Ends when the time is over.
 * Errors: MEMORY, CANCELLED. */
starg_status widen(partition *p, uint64_t work);

#endif
