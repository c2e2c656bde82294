/* SPDX-License-Identifier: Apache-2.0 */
/* Coplanar merge: undoes splits of facets that no cut needs any more. */
#ifndef STARG_STAR_STRICT_PARTITION_MERGE_COPLANAR_H
#define STARG_STAR_STRICT_PARTITION_MERGE_COPLANAR_H

#include "star/strict/partition/partition.h"

/* Facets in one plane between the same two pieces are made anew with the vertices that their
 * borders need; points that nothing uses go. The pieces stay the same but for rounding; they are
 * certified again, and when that fails nothing is changed. The index is built again. Errors:
 * MEMORY.
 */
starg_status merge_coplanar(partition *p);

/* The same for pieces whose guards do not see them yet: nothing is certified. Errors: MEMORY. */
starg_status merge_coplanar_unproven(partition *p);

#endif
