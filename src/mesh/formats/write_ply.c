/* SPDX-License-Identifier: Apache-2.0 */
/* PLY: double coordinates, lists of int, colours of faces, or else of vertices, as uchar red,
 * green, blue, and texture coordinates of a face's corners as a list of float named texcoord, which
 * many programs read. */
#include "mesh/formats/io.h"

typedef enum number_type { BYTE, INT, FLOAT, DOUBLE } number_type;

/* Text has a line for each item. */
typedef struct ply_sink {
    FILE *stream;
    bool text, begun; /* begun: the line has a number */
} ply_sink;

static void put(ply_sink *sink, number_type type, double value) {
    static const size_t sizes[] = {[BYTE] = 1, [INT] = 4, [FLOAT] = 4, [DOUBLE] = 8};
    unsigned char bytes[8];
    if (sink->text) {
        fprintf(sink->stream, sink->begun ? " %.*g" : "%.*g", type == FLOAT ? 9 : 17, value);
        sink->begun = true;
        return;
    }
    if (type == BYTE)
        *bytes = (unsigned char)value;
    else if (type == INT)
        pack_u32(bytes, (uint32_t)value);
    else if (type == FLOAT)
        pack_f32(bytes, (float)value);
    else
        pack_f64(bytes, value);
    fwrite(bytes, 1, sizes[type], sink->stream);
}

static void put_color(ply_sink *sink, const uint8_t *colors, size_t item) {
    for (size_t k = 0; colors != NULL && k < 3; k++)
        put(sink, BYTE, colors[3 * item + k]);
}

static void end_item(ply_sink *sink) {
    if (sink->text)
        fputc('\n', sink->stream);
    sink->begun = false;
}

/* Colours of vertices. Programs would show them in place of those of faces. */
static const uint8_t *tint_of(const starg_mesh *mesh, const starg_mesh_extras *extras) {
    return extras->colors == NULL ? mesh->colors : NULL;
}

static void write_header(FILE *stream, const char *encoding, const starg_mesh *mesh,
                         const starg_mesh_extras *extras) {
    static const char color[] = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    bool noted = extras->note[0] != '\0';
    fprintf(stream,
            "ply\nformat %s 1.0\n%s%s%s"
            "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n%s"
            "element face %zu\nproperty list uchar int vertex_indices\n%s%send_header\n",
            encoding, noted ? "comment " : "", extras->note, noted ? "\n" : "", mesh->vertex_count,
            tint_of(mesh, extras) != NULL ? color : "", mesh->face_count,
            mesh->texture != NULL ? "property list uchar float texcoord\n" : "",
            extras->colors != NULL ? color : "");
}

static void write_items(ply_sink *sink, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        for (size_t k = 0; k < 3; k++)
            put(sink, DOUBLE, mesh->vertices[3 * i + k]);
        put_color(sink, tint_of(mesh, extras), i);
        end_item(sink);
    }
    for (size_t i = 0; i < mesh->face_count; i++) {
        put(sink, BYTE, 3);
        for (size_t k = 0; k < 3; k++)
            put(sink, INT, mesh->faces[3 * i + k]);
        if (mesh->texture != NULL)
            put(sink, BYTE, 6);
        for (size_t k = 0; mesh->texture != NULL && k < 6; k++)
            put(sink, FLOAT, (double)mesh->texture[6 * i + k]);
        put_color(sink, extras->colors, i);
        end_item(sink);
    }
}

void starg_ply_write_ascii(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    write_header(stream, "ascii", mesh, extras);
    write_items(&(ply_sink){.stream = stream, .text = true}, mesh, extras);
}

void starg_ply_write_binary(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    write_header(stream, "binary_little_endian", mesh, extras);
    write_items(&(ply_sink){.stream = stream}, mesh, extras);
}
