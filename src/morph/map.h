/* Inside of a map. */
#ifndef STARG_MORPH_MAP_H
#define STARG_MORPH_MAP_H

#include "starguard/morph.h"

/* A map with room for its tables. Errors: MEMORY. */
starg_status map_make(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                      starg_map_kind kind, starg_map **out);

/* Fills in how much the map distorts. Errors: MEMORY. */
starg_status map_measure(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                         starg_map *map);

/* Are the faces the same? */
bool map_same_faces(const starg_mesh *a, const starg_mesh *b);

/* Every vertex to the vertex of its number; B has A's faces. Errors: MESH, MEMORY. */
starg_status map_identity(starg_context *context, const starg_mesh *b, starg_map *map);

/* A copy within a unit cube about the origin. Errors: MESH (no extent), MEMORY. */
starg_status map_unit_copy(starg_context *context, const starg_mesh *mesh, starg_mesh **out);

#endif
