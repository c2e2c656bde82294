/* SPDX-License-Identifier: Apache-2.0 */
/* OBJ: lines of v and f; indices count from 1. Face colours are not supported. */
#include <inttypes.h>

#include "mesh/formats/io.h"

void starg_obj_write(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    if (extras->note[0] != '\0')
        fprintf(stream, "# %s\n", extras->note);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const double *p = mesh->vertices + 3 * i;
        fprintf(stream, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (size_t i = 0; i < mesh->face_count; i++) {
        const uint32_t *f = mesh->faces + 3 * i;
        fprintf(stream, "f %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", f[0] + 1, f[1] + 1, f[2] + 1);
    }
}
