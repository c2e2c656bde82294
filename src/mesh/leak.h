/* SPDX-License-Identifier: Apache-2.0 */
/* Where the space that is reached from a point leaks. */
#ifndef STARG_MESH_LEAK_H
#define STARG_MESH_LEAK_H

#include "core/memory.h"
#include "mesh/flood.h"

typedef struct flood_leak {
    bool outside;            /* it leads out of the model's box */
    bool gap;                /* through a gap hardly wider than a cube */
    double place[3];         /* of the gap, or the wider opening */
    STARG_ARRAY(double) way; /* 3 numbers for each point; none: there is no leak */
} flood_leak;

/* Free `way`. Errors: MEMORY, CANCELLED. */
starg_status flood_find_leak(const flood_cells *cells, const bvh_box *model, const double from[3],
                             flood_leak *out);

#endif
