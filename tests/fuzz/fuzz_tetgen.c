/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes as TetGen's pair of files, .node up to the first line of a dash, .ele behind it: no
 * crash, a sound mesh or an error that says something. */
#include <math.h>
#include <string.h>

#include "starguard/tetra.h"
#include "support.h"

static void require_sound(const starg_tetmesh *mesh) {
    size_t vertices = starg_tetmesh_vertex_count(mesh), count = starg_tetmesh_count(mesh);
    for (size_t i = 0; i < 3 * vertices; i++)
        fuzz_require(fabs(starg_tetmesh_vertices(mesh)[i]) < 1e100, "coordinates are in range");
    for (size_t i = 0; i < 4 * count; i++)
        fuzz_require(starg_tetmesh_tetrahedra(mesh)[i] < vertices, "indices are in range");
}

/* Where the second file begins, or the end. */
static size_t find_second(const unsigned char *data, size_t size) {
    for (size_t i = 2; i < size; i++)
        if (memcmp(data + i - 2, "\n-\n", 3) == 0)
            return i + 1;
    return size;
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = fuzz_context();
    starg_tetmesh *mesh = NULL;
    size_t second = find_second(data, size);
    const char *path = fuzz_file(".node", data, second < size ? second - 2 : size);
    fuzz_file(".ele", data + second, size - second);
    starg_status status = starg_tetmesh_read(context, path, &mesh);
    if (status == STARG_OK)
        require_sound(mesh);
    else
        fuzz_require_explained(context, status);
    starg_tetmesh_free(mesh);
    fuzz_context_end(context);
    return 0;
}
