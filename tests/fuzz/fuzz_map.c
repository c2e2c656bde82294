/* Any bytes as a MAP.json between a tetrahedron and a cube: read or rejected with a message; what
 * is read puts every vertex on the target. */
#include <stdlib.h>

#include "starguard/morph.h"
#include "support.h"

static void check_map(const starg_map *map, const starg_mesh *a, const starg_mesh *b) {
    double positions[3 * FUZZ_VERTICES], lower[3], upper[3];
    size_t vertices = starg_mesh_vertex_count(a);
    fuzz_require(map->vertex_count == vertices && map->kind == STARG_MAP_GIVEN,
                 "the map is one of these meshes");
    starg_mesh_bounds(b, lower, upper);
    starg_map_positions(map, b, positions);
    for (size_t v = 0; v < vertices; v++)
        fuzz_require(map->faces[v] < starg_mesh_face_count(b), "faces are in range");
    for (size_t i = 0; i < 3 * vertices; i++)
        fuzz_require(positions[i] >= lower[i % 3] - 1e-6 && positions[i] <= upper[i % 3] + 1e-6,
                     "images are near the target");
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = fuzz_context();
    shape from = shape_tetrahedron(), to = shape_cube(1);
    starg_mesh *a = fuzz_mesh(context, &from), *b = fuzz_mesh(context, &to);
    starg_map *map = NULL;
    starg_status status = starg_map_read(context, fuzz_file(".json", data, size), a, b, &map);
    if (status == STARG_OK)
        check_map(map, a, b);
    else
        fuzz_require_explained(context, status);
    starg_map_free(context, map);
    starg_mesh_free(a);
    starg_mesh_free(b);
    shape_free(&from);
    shape_free(&to);
    fuzz_context_end(context);
    return 0;
}
