/* SPDX-License-Identifier: Apache-2.0 */
/* Any bytes given to the mesh readers, under a name that has FUZZ_NAME's extension: no crash, a
 * sound mesh or an error that says something, all memory returned, and never much more of it taken
 * than the input is long. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "starguard/mesh.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

static void require(bool condition, const char *what) {
    if (condition)
        return;
    fprintf(stderr, "violated: %s\n", what);
    abort();
}

static void require_sound(const starg_mesh *mesh) {
    size_t vertices = starg_mesh_vertex_count(mesh), faces = starg_mesh_face_count(mesh);
    require(vertices > 0 && faces > 0, "a mesh that was read has vertices and faces");
    for (size_t i = 0; i < 3 * vertices; i++)
        require(fabs(starg_mesh_vertices(mesh)[i]) < 1e100, "coordinates are in range");
    for (size_t i = 0; i < 3 * faces; i++)
        require(starg_mesh_faces(mesh)[i] < vertices, "indices are in range");
}

static void require_explained(const starg_context *context, starg_status status) {
    const starg_error *error = starg_context_error(context);
    require(status == STARG_ERROR_FORMAT || status == STARG_ERROR_RANGE,
            "bad bytes are FORMAT or RANGE errors");
    require(error->status == status, "the detail belongs to the status");
    require(strstr(error->message, FUZZ_NAME) != NULL, "the message names the file");
    for (const char *at = error->message; *at != '\0'; at++)
        require(*at >= ' ' && *at <= '~', "the message is printable");
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    enum { SLACK = 1 << 16 };
    /* zlib saves a factor of 1032, and a coordinate of one byte becomes one of eight */
    const size_t bytes_per_byte = strstr(FUZZ_NAME, ".vtp") != NULL ? 1 << 14 : 64;
    starg_context *context = NULL;
    starg_mesh *mesh = NULL;
    require(starg_context_create(NULL, &context) == STARG_OK, "a context can be made");
    starg_status status = starg_mesh_read_memory(context, data, size, FUZZ_NAME, &mesh);
    require((mesh != NULL) == (status == STARG_OK), "there is a mesh or an error");
    if (mesh != NULL)
        require_sound(mesh);
    else
        require_explained(context, status);
    starg_mesh_free(mesh);
    require(starg_context_live_blocks(context) == 0, "all memory is returned");
    require(starg_context_peak_bytes(context) <= SLACK + bytes_per_byte * size,
            "memory stays in proportion to the input");
    starg_context_free(context);
    return 0;
}
