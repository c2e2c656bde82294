/* SPDX-License-Identifier: Apache-2.0 */
/* BSP start: cuts by planes until every piece is star-shaped. */
#ifndef STARG_STAR_STRICT_START_BSP_START_H
#define STARG_STAR_STRICT_START_BSP_START_H

#include "star/strict/partition/partition.h"

/* Cuts the pieces of a partition, whose guards need not see anything, until each has a certified
 * guard. *done is false, and the partition of no use, when some piece resists (as one whose surface
 * touches itself along an edge does) until open pieces have been looked at `budget` times, some two
 * or three times for each piece if none resists; or when the time is over. Another stream of random
 * numbers gives another result. Errors: MEMORY, CANCELLED. */
starg_status bsp_start(partition *p, uint64_t stream, size_t budget, bool *done);

#endif
