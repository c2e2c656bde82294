/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of a surface: a subdivision of its mesh, dense enough for the Voronoi diagram. */
#pragma once

#include "mesh/solid.h"

/* A closed mesh on the solid's faces. Its first points are the vertices of the solid. */
typedef struct surface_samples {
    size_t point_count, face_count;
    double *points;
    uint32_t *faces;
} surface_samples;

/* Subdivides until no edge is much longer than with at least `wanted` points evenly on the surface.
 * If `moved`, they are a little off the surface, so that no five are cospherical. Errors: MEMORY,
 * CANCELLED. */
starg_status samples_create(starg_context *context, const starg_solid *solid, size_t wanted,
                            bool moved, surface_samples *samples);
void samples_free(surface_samples *samples);
