/* SPDX-License-Identifier: Apache-2.0 */
/* Decides which Delaunay tetrahedra of surface samples lie inside the solid. */
#pragma once

#include "geometry/delaunay.h"
#include "skeleton/samples.h"

typedef struct inside_labels {
    bool *inside;      /* per tetrahedron */
    bool *found;       /* per face of the samples: is it a face of tetrahedra? */
    size_t lost_count; /* faces that are not */
} inside_labels;

/* If no face is lost, the inside tetrahedra fill exactly what the samples bound. Otherwise the two
 * sides meet in the narrowest triangles of the gaps. Errors: MEMORY. */
starg_status labels_create(starg_context *context, const starg_solid *solid,
                           const surface_samples *samples, const delaunay *tetrahedra,
                           inside_labels *labels);
void labels_free(inside_labels *labels);
