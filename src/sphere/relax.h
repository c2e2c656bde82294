/* SPDX-License-Identifier: Apache-2.0 */
/* Evens out an embedding of a triangulated sphere in the unit sphere. */
#ifndef STARG_SPHERE_RELAX_H
#define STARG_SPHERE_RELAX_H

#include "sphere/rings.h"

typedef struct relaxation {
    const rings *rings;
    double *directions;    /* vertex_count x 3, of length about 1; changed in place      */
    const uint32_t *alive; /* the vertices that may move, in the order in which they do  */
    size_t alive_count;
    const uint8_t *pinned; /* per vertex: must not move; NULL: none                      */
    double floor;          /* squared length that is added to every edge of the surface  */
} relaxation;

/* Moves each vertex downhill once. Every triangle about it stays positive, exactly. */
void relax_sweep(const relaxation *relaxation);

/* Is every triangle about a vertex positively oriented as seen from outside? Exact. */
bool relax_is_positive(const ring *around, const double *directions, const double at[3])
    STARG_PRIVATE(relax_is_positive);

#endif
