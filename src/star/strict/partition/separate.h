/* SPDX-License-Identifier: Apache-2.0 */
/* How the surface of a piece hangs together; connected parts made pieces of their own. */
#ifndef STARG_STAR_STRICT_PARTITION_SEPARATE_H
#define STARG_STAR_STRICT_PARTITION_SEPARATE_H

#include "star/strict/partition/partition.h"

/* Parts of piece `number` that share no edge become pieces: the first keeps the number, the
 * others come last. A piece with a cavity stays whole, for the cavity's surface belongs to a part
 * that it does not touch. Needs the index and builds it again. Guards are the caller's. Errors:
 * MEMORY. */
starg_status partition_separate(partition *p, uint32_t number);

/* Does some edge have other than two facets of the piece? Then planes across it cannot cut the
 * piece (star/strict/partition/slice.h). Needs the index. Errors: MEMORY. */
starg_status partition_touches_itself(const partition *p, uint32_t number, bool *touches);

#endif
