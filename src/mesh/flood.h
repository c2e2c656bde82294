/* SPDX-License-Identifier: Apache-2.0 */
/* Space that can be reached from a point, in cubes. */
#ifndef STARG_MESH_FLOOD_H
#define STARG_MESH_FLOOD_H

#include "mesh/solid.h"

typedef struct flood_cells {
    starg_context *context;
    double origin[3], size;
    size_t count[3], reached;
    uint64_t *taken, *bits; /* met by a face; reached */
} flood_cells;

/* The cube of p; false where p is out of the grid. */
bool flood_locate(const flood_cells *cells, const double p[3], size_t at[3]);

/* The cubes of `size` in the reach of a scene (solid_reach) that are connected to that of `from`
 * over sides, through cubes that no face meets. Errors: ARGUMENT (`from` is out of reach or in a
 * cube that a face meets; too many cubes), MEMORY, CANCELLED. */
starg_status flood_create(starg_context *context, const starg_solid *scene, const double from[3],
                          double size, flood_cells **out);
void flood_free(flood_cells *cells);

/* Is p in one of them? */
bool flood_reaches(const flood_cells *cells, const double p[3]);

/* Is a point of the box in one of them, as far as is known? */
bool flood_meets(const flood_cells *cells, const bvh_box *box);

/* Their volume. */
double flood_volume(const flood_cells *cells);

#endif
