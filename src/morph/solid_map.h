/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of maps between solids. */
#ifndef STARG_MORPH_SOLID_MAP_H
#define STARG_MORPH_SOLID_MAP_H

#include "starguard/solidmap.h"

/* Exponents of the extents of both places, as units of length. */
void solid_map_exponents(const starg_solid_map *map, int out[2]);

/* The largest over the smallest singular value of a tetrahedron's map, and its volume in A, in those
 * units. */
double solid_map_ratio(const starg_solid_map *map, size_t t, const int exponents[2],
                       double *volume);

#endif
