/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of a map. */
#ifndef STARG_MORPH_MAP_H
#define STARG_MORPH_MAP_H

#include "core/fields.h"
#include "starguard/morph.h"

/* MAP.json as a starg_map. */
extern const starg_fields map_file_fields;

/* Allocates a map and its tables. Errors: MEMORY. */
starg_status map_make(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                      starg_map_kind kind, starg_map **out);

/* Fills in the distortion of the map. Errors: MEMORY. */
starg_status map_measure(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map);

/* Number of faces that differ at equal positions in the lists; SIZE_MAX if counts differ. */
size_t map_different_faces(const starg_mesh *a, const starg_mesh *b);

/* Maps every vertex to the vertex with its number. Errors: MESH, MEMORY. */
starg_status map_identity(starg_context *context, const starg_mesh *b, starg_map *map);

/* A copy scaled to a unit cube about the origin. Errors: MESH (no extent), MEMORY. */
starg_status map_unit_copy(starg_context *context, const starg_mesh *mesh, starg_mesh **out);

#endif
