/* SPDX-License-Identifier: Apache-2.0 */
/* Guards where tetrahedra are less flat. */
#ifndef STARG_STAR_STRICT_FINISH_SETTLE_H
#define STARG_STAR_STRICT_FINISH_SETTLE_H

#include "star/strict/partition/partition.h"

/* Moves guards within their kernels, so that angles lack less, with at least these margins (one for
 * each piece, in unit coordinates). Looks at about `looks` facets at most, and subtracts how many
 * it looked at. The partition has an index. Errors: MEMORY, CANCELLED. */
starg_status settle_guards(partition *p, const double *margins, uint64_t *looks, bool *any);

#endif
