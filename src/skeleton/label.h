/* SPDX-License-Identifier: Apache-2.0 */
/* Which Delaunay tetrahedra of surface samples lie inside the solid. */
#ifndef STARG_SKELETON_LABEL_H
#define STARG_SKELETON_LABEL_H

#include "geometry/delaunay.h"
#include "mesh/solid.h"
#include "skeleton/samples.h"

typedef struct inside_labels {
    bool *inside;      /* of each tetrahedron                                                  */
    bool *found;       /* of each face of the samples: is it a face of tetrahedra?             */
    size_t lost_count; /* faces that are not                                                   */
} inside_labels;

/* With no face lost the tetrahedra inside fill exactly what the samples bound. Else the two sides
 * meet in the narrowest triangles of the gaps. Errors: MEMORY. */
starg_status labels_create(starg_context *context, const starg_solid *solid,
                           const surface_samples *samples, const delaunay *tetrahedra,
                           inside_labels *labels);
void labels_free(starg_context *context, inside_labels *labels);

#endif
