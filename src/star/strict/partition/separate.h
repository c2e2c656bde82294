/* SPDX-License-Identifier: Apache-2.0 */
/* Splits a piece into its connected parts. */
#ifndef STARG_STAR_STRICT_PARTITION_SEPARATE_H
#define STARG_STAR_STRICT_PARTITION_SEPARATE_H

#include "star/strict/partition/partition.h"

/* Turns parts of piece `number` that share no edge into pieces: the first keeps the number, the
 * others come last. A piece with a cavity stays whole, because the cavity's surface belongs to a
 * part that it does not touch. Needs the index and rebuilds it. The caller sets the guards. Errors:
 * MEMORY. */
starg_status partition_separate(partition *p, uint32_t number);

#endif
