/* SPDX-License-Identifier: Apache-2.0 */
/* OFF: counts, vertices, faces with a colour (0 to 255) after the indices. */
#include <inttypes.h>

#include "mesh/formats/io.h"

void starg_off_write(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    const uint8_t *colors = extras->colors;
    fprintf(stream, "OFF\n%zu %zu 0\n", mesh->vertex_count, mesh->face_count);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const double *p = mesh->vertices + 3 * i;
        fprintf(stream, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (size_t i = 0; i < mesh->face_count; i++) {
        const uint32_t *f = mesh->faces + 3 * i;
        fprintf(stream, "3 %" PRIu32 " %" PRIu32 " %" PRIu32, f[0], f[1], f[2]);
        if (colors != NULL)
            fprintf(stream, " %d %d %d", colors[3 * i], colors[3 * i + 1], colors[3 * i + 2]);
        fputc('\n', stream);
    }
}
