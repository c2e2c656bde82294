/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts through compatible tetrahedra: the same surface in both places. */
#ifndef STARG_STAR_COMPATIBLE_THROUGH_H
#define STARG_STAR_COMPATIBLE_THROUGH_H

#include "core/memory.h"
#include "tetra/tetmesh.h"

/* Some tetrahedra of a mesh, and a level at each of their vertices: where it is 0, inside of
 * tetrahedra too, is the cut. What is below is part 0, what is above part 1. */
typedef struct through_cut {
    starg_context *context;
    const starg_tetmesh *meshes[2];
    const uint8_t *inside;          /* per tetrahedron: is it one of them? */
    double *levels;                 /* per vertex; 0 for those of no such tetrahedron */
    STARG_ARRAY(uint64_t) edges;    /* that cross the cut, ascending: lower vertex << 32 | upper */
    STARG_ARRAY(double) places[2];  /* of the vertices, and of the points where edges cross */
    STARG_ARRAY(uint32_t) faces[2]; /* around the parts */
} through_cut;

void through_free(through_cut *cut);

/* Moves the cut onto vertices that it passes near, and finds where it crosses edges. *found: there
 * is something on either side. Errors: MEMORY. */
starg_status through_place(through_cut *cut, bool *found);

/* The same, and guards of both parts in both places: guards[part][place]. *found: there are any.
 * Errors: MEMORY, CANCELLED. */
starg_status through_find(through_cut *cut, double guards[2][2][3], bool *found);

/* After either: divides the tetrahedra, and those beside them that have a common edge. `labels` has
 * one for each; those of the parts become THROUGH_PART + part. *good: all are positive in both
 * places, exactly; else there is no result. Errors: MEMORY, CANCELLED. */
#define THROUGH_PART (UINT32_MAX - 2)
starg_status through_divide(const through_cut *cut, const uint32_t *labels, starg_tetmesh *out[2],
                            uint32_t **out_labels, bool *good);

#endif
