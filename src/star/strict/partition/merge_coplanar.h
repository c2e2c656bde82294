/* SPDX-License-Identifier: Apache-2.0 */
/* Coplanar merge: undoes splits of facets that no cut needs any longer. */
#ifndef STARG_STAR_STRICT_PARTITION_MERGE_COPLANAR_H
#define STARG_STAR_STRICT_PARTITION_MERGE_COPLANAR_H

#include "star/strict/partition/partition.h"

/* Retriangulates facets in one plane between the same two pieces with only the vertices that their
 * borders need; removes unused points. The pieces stay the same up to rounding; they are certified
 * again, and if that fails, nothing changes. Rebuilds the index. Errors: MEMORY. */
starg_status merge_coplanar(partition *p);

/* The same for pieces whose guards do not see them yet: certifies nothing. Errors: MEMORY. */
starg_status merge_coplanar_unproven(partition *p);

#endif
