/* SPDX-License-Identifier: Apache-2.0 */
/* Erosion of the medial complex to a graph. */
#ifndef STARG_SKELETON_EROSION_H
#define STARG_SKELETON_EROSION_H

#include "skeleton/complex.h"

typedef struct erosion {
    bool *link_left;  /* of each link: is it in the graph that remains? */
    double *values;   /* of each edge: its medial geodesic function */
    size_t cut_count; /* sheets that had to be cut open, because no order of collapses goes on */
} erosion;

/* Errors: MEMORY, CANCELLED. */
starg_status erosion_run(starg_context *context, const medial_complex *complex, erosion *result);
void erosion_free(starg_context *context, erosion *result);

#endif
