/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes given to the readers of tetrahedral meshes: no crash, a sound mesh or an error that
 * says something, all memory returned, and never much more of it taken than the input is long. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/tetra.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

static void require(bool condition, const char *what) {
    if (condition)
        return;
    fprintf(stderr, "violated: %s\n", what);
    abort();
}

static void require_sound(const starg_tetmesh *mesh) {
    size_t vertices = starg_tetmesh_vertex_count(mesh), count = starg_tetmesh_count(mesh);
    require(vertices >= 4 && count > 0, "a mesh that was read has vertices and tetrahedra");
    for (size_t i = 0; i < 3 * vertices; i++)
        require(fabs(starg_tetmesh_vertices(mesh)[i]) < 1e100, "coordinates are in range");
    for (size_t i = 0; i < 4 * count; i++) {
        uint32_t next = starg_tetmesh_neighbours(mesh)[i];
        require(starg_tetmesh_tetrahedra(mesh)[i] < vertices, "indices are in range");
        require(next == STARG_TETMESH_NONE || next < count, "neighbours are in range");
    }
}

static void require_explained(const starg_context *context, starg_status status) {
    const starg_error *error = starg_context_error(context);
    require(status == STARG_ERROR_FORMAT || status == STARG_ERROR_RANGE ||
                status == STARG_ERROR_MESH,
            "bad bytes are FORMAT, RANGE or MESH errors");
    require(error->status == status, "the detail belongs to the status");
    require(status == STARG_ERROR_MESH || strstr(error->message, "fuzz.tet") != NULL,
            "the message names the file");
    for (const char *at = error->message; *at != '\0'; at++)
        require(*at >= ' ' && *at <= '~', "the message is printable");
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    enum { BYTES_PER_BYTE = 128, SLACK = 1 << 16 };
    starg_context *context = NULL;
    starg_tetmesh *mesh = NULL;
    require(starg_context_create(NULL, &context) == STARG_OK, "a context can be made");
    starg_status status = starg_tetmesh_read_memory(context, data, size, "fuzz.tet", &mesh);
    require((mesh != NULL) == (status == STARG_OK), "there is a mesh or an error");
    if (mesh != NULL)
        require_sound(mesh);
    else
        require_explained(context, status);
    starg_tetmesh_free(mesh);
    require(starg_context_live_blocks(context) == 0, "all memory is returned");
    require(starg_context_peak_bytes(context) <= SLACK + BYTES_PER_BYTE * size,
            "memory stays in proportion to the input");
    starg_context_free(context);
    return 0;
}
