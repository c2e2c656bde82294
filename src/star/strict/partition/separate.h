/* SPDX-License-Identifier: Apache-2.0 */
/* Connected parts of a piece made pieces of their own. */
#ifndef STARG_STAR_STRICT_PARTITION_SEPARATE_H
#define STARG_STAR_STRICT_PARTITION_SEPARATE_H

#include "star/strict/partition/partition.h"

/* Parts of piece `number` that share no edge become pieces: the first keeps the number, the
 * others come last. A piece with a cavity stays whole, for the cavity's surface belongs to a part
 * that it does not touch. Needs the index and builds it again. Guards are the caller's. Errors:
 * MEMORY. */
starg_status partition_separate(partition *p, uint32_t number);

#endif
