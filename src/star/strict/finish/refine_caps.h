/* SPDX-License-Identifier: Apache-2.0 */
/* Better triangles in the borders between pieces. */
#ifndef STARG_STAR_STRICT_FINISH_REFINE_CAPS_H
#define STARG_STAR_STRICT_FINISH_REFINE_CAPS_H

#include "star/strict/partition/partition.h"

/* Adds vertices within plane borders between two pieces where the tetrahedra on them have small
 * dihedral angles, and triangulates these borders anew. Pieces and guards stay the same. Errors:
 * MEMORY. */
starg_status refine_caps(partition *p);

#endif
