/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of a map. */
#pragma once

#include "core/fields.h"
#include "starguard/morph.h"

/* MAP.json as a starg_map. */
extern const starg_fields map_file_fields;

/* Fills in the distortion of the map. Errors: MEMORY. */
starg_status map_measure(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map);

/* Positions of `count` points by faces and barycentric coordinates. */
void map_place(const starg_mesh *mesh, size_t count, const uint32_t *faces,
               const double *coordinates, double *positions);

/* Gives a map that keeps vertices directions of A's embedding, changed so that B's faces are
 * positive too, for both surfaces. Errors: MESH (not of genus 0), SOLVER, MEMORY, CANCELLED. */
starg_status map_share_directions(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                                  starg_map *map);

/* starg_map_overlay; *moved: corners had to be moved, so that not all are in the directions of the
 * map (map_overlay.c). */
starg_status map_overlay(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map, bool *moved);

/* Frees its arrays (map_overlay.c). */
void map_free_overlay(starg_overlay *overlay);

/* A copy scaled to a unit cube about the origin. Errors: MESH (no extent), MEMORY. */
starg_status map_unit_copy(starg_context *context, const starg_mesh *mesh, starg_mesh **out);

static inline void starg_map_drop(starg_map **map) {
    starg_map_free(NULL, *map);
}
