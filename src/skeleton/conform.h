/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of a surface that their own Delaunay tetrahedra follow. */
#ifndef STARG_SKELETON_CONFORM_H
#define STARG_SKELETON_CONFORM_H

#include "geometry/delaunay.h"
#include "skeleton/samples.h"

/* Changed samples and their tetrahedra. */
typedef struct conformed {
    surface_samples samples;
    delaunay *tetrahedra;
    size_t lost; /* faces of the samples that are no faces of tetrahedra */
} conformed;

/* As many as there are manners of adding points, and one without any. */
enum { CONFORM_RESULTS = 5 };

/* Changes the samples, a closed manifold mesh, until each of its faces is a face of the Delaunay
 * tetrahedra of its points or the work is over. One manner after another is tried until no face is
 * lost; the results are in the order of the faces lost, the fewest first. The samples are taken
 * over. All results are to be freed, after errors too. Errors: MEMORY, CANCELLED. */
starg_status conform_samples(starg_context *context, surface_samples *samples,
                             conformed results[CONFORM_RESULTS], size_t *count);
void conformed_free(starg_context *context, conformed *result);

#endif
