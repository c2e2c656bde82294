/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of a surface whose faces are faces of their Delaunay tetrahedra. */
#pragma once

#include "geometry/delaunay.h"
#include "skeleton/samples.h"

/* Modified samples and their tetrahedra. */
typedef struct conformed {
    surface_samples samples;
    delaunay *tetrahedra;
    size_t lost; /* faces of the samples that are not faces of tetrahedra */
} conformed;

/* One per strategy of inserting points, and one without points. */
enum { CONFORM_RESULTS = 5 };

/* Modifies the samples, a closed manifold mesh, until each face is a face of the Delaunay
 * tetrahedra of its points or the work limit is reached. Tries strategies until no face is lost;
 * sorts the results by lost faces, fewest first. Takes ownership of the samples. All results must
 * be freed, after errors too. Errors: MEMORY, CANCELLED. */
starg_status conform_samples(starg_context *context, surface_samples *samples,
                             conformed results[CONFORM_RESULTS], size_t *count);
void conformed_free(conformed *result);
