/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as landmarks between a tetrahedron and a cube: read or rejected with a message; what is
 * read names vertices that there are, and maps are made of it or not, without losing anything. */
#include <stdlib.h>
#include <string.h>

#include "starguard/morph.h"
#include "support.h"

/* A map that is made meets every landmark. */
static void check_map(starg_context *context, const starg_mesh *a, const starg_mesh *b,
                      const uint32_t *pairs, size_t count) {
    const starg_map_options options = {.landmarks = pairs, .landmark_count = count};
    starg_map *map = NULL;
    double images[3 * FUZZ_VERTICES];
    starg_status status = starg_map_create(context, a, b, &options, &map);
    fuzz_require(status == STARG_OK || status == STARG_ERROR_ARGUMENT ||
                     status == STARG_ERROR_MESH || status == STARG_ERROR_SOLVER,
                 "landmarks are met or refused");
    if (map == NULL)
        return;
    starg_map_positions(map, b, images);
    for (size_t i = 0; i < count; i++)
        fuzz_require(memcmp(images + 3 * (size_t)pairs[2 * i],
                            starg_mesh_vertices(b) + 3 * (size_t)pairs[2 * i + 1],
                            3 * sizeof *images) == 0,
                     "landmarks are met exactly");
    starg_map_free(context, map);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = fuzz_context();
    shape from = shape_tetrahedron(), to = shape_cube(1);
    starg_mesh *a = fuzz_mesh(context, &from), *b = fuzz_mesh(context, &to);
    uint32_t *pairs = NULL;
    size_t count = 0;
    starg_status status =
        starg_landmarks_read(context, fuzz_file(".txt", data, size), a, b, &pairs, &count);
    if (status != STARG_OK)
        fuzz_require_explained(context, status);
    for (size_t i = 0; i < count; i++)
        fuzz_require(pairs[2 * i] < starg_mesh_vertex_count(a) &&
                         pairs[2 * i + 1] < starg_mesh_vertex_count(b),
                     "vertices are in range");
    if (count > 0 && count < 6)
        check_map(context, a, b, pairs, count);
    starg_landmarks_free(context, pairs);
    starg_mesh_free(a);
    starg_mesh_free(b);
    shape_free(&from);
    shape_free(&to);
    fuzz_context_end(context);
    return 0;
}
