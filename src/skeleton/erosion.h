/* SPDX-License-Identifier: Apache-2.0 */
/* Erosion of the medial complex to a graph. */
#pragma once

#include "skeleton/complex.h"

typedef struct erosion {
    bool *link_left;  /* per link: is it in the remaining graph? */
    double *values;   /* per edge: its medial geodesic function */
    size_t cut_count; /* sheets cut because no collapse was possible */
} erosion;

/* Errors: MEMORY, CANCELLED. */
starg_status erosion_run(starg_context *context, const medial_complex *complex, erosion *result);
void erosion_free(erosion *result);
