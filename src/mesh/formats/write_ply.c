/* SPDX-License-Identifier: Apache-2.0 */
/* PLY: double coordinates, lists of int, and the colours of faces as uchar red, green, blue. */
#include "mesh/formats/io.h"
#include "mesh/formats/pack.h"

static void write_header(FILE *stream, const char *encoding, const starg_mesh *mesh,
                         const starg_mesh_extras *extras) {
    bool noted = extras->note[0] != '\0';
    fprintf(stream,
            "ply\nformat %s 1.0\n%s%s%s"
            "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
            "element face %zu\nproperty list uchar int vertex_indices\n",
            encoding, noted ? "comment " : "", extras->note, noted ? "\n" : "", mesh->vertex_count,
            mesh->face_count);
    if (extras->colors != NULL)
        fputs("property uchar red\nproperty uchar green\nproperty uchar blue\n", stream);
    fputs("end_header\n", stream);
}

void starg_ply_write_ascii(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    write_header(stream, "ascii", mesh, extras);
    starg_write_lines(stream, mesh, extras->colors);
}

void starg_ply_write_binary(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    enum { VERTEX = 24, FACE = 13, COLOR = 3 };
    const uint8_t *colors = extras->colors;
    write_header(stream, "binary_little_endian", mesh, extras);
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        unsigned char record[VERTEX];
        for (size_t k = 0; k < 3; k++)
            pack_f64(record + 8 * k, mesh->vertices[3 * i + k]);
        fwrite(record, 1, sizeof record, stream);
    }
    for (size_t i = 0; i < mesh->face_count; i++) {
        unsigned char record[FACE + COLOR] = {3};
        for (size_t k = 0; k < 3; k++)
            pack_u32(record + 1 + 4 * k, mesh->faces[3 * i + k]);
        if (colors != NULL)
            memcpy(record + FACE, colors + 3 * i, COLOR);
        fwrite(record, 1, colors != NULL ? FACE + COLOR : FACE, stream);
    }
}
