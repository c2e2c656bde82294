/* SPDX-License-Identifier: Apache-2.0 */
/* Welding: merges points at exactly equal positions. */
#pragma once

#include "mesh/formats/io.h"

typedef struct starg_weld {
    starg_mesh_builder *builder;
    uint32_t *slots; /* vertex + 1, or 0 for a free slot; open addressing, at most half full */
    size_t size;     /* a power of two */
} starg_weld;

/* The builder's vertex at `point`, appended if it is new; vertices are in order of first
 * appearance, and -0 equals 0. Errors: RANGE, MEMORY. */
starg_status starg_weld_point(starg_weld *weld, const double point[3], starg_place place,
                              uint32_t *vertex);
void starg_weld_free(starg_weld *weld);
