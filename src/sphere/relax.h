/* SPDX-License-Identifier: Apache-2.0 */
/* Relaxes an embedding of a triangulated sphere in the unit sphere. */
#ifndef STARG_SPHERE_RELAX_H
#define STARG_SPHERE_RELAX_H

#include "sphere/rings.h"

typedef struct relaxation {
    const rings *rings;
    double *directions;    /* vertex_count x 3, of length about 1; changed in place */
    const uint32_t *alive; /* the movable vertices, in the order of moving */
    size_t alive_count;
    const uint8_t *pinned; /* per vertex: fixed; NULL: none */
    double floor;          /* squared length added to every edge of the surface */
} relaxation;

/* Moves each vertex downhill once. Its triangles stay positive, exactly. */
void relax_sweep(const relaxation *relaxation);

/* Is every triangle at a vertex positive as seen from outside? Exact. */
bool relax_is_positive(const ring *around, const double *directions, const double at[3])
    STARG_PRIVATE(relax_is_positive);

#endif
