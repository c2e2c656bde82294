/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a legacy VTK unstructured grid of tetrahedra, as text or binary (big endian), with a label
 * and points for each. The file gets its name once it is complete. */
#include <ctype.h>

#include "mesh/formats/io.h"
#include "tetra/tetmesh.h"

enum { VTK_TETRAHEDRON = 10 };

typedef struct writer {
    FILE *stream;
    bool binary;
} writer;

void starg_tetmesh_write_options_default(starg_tetmesh_write_options *options) {
    *options = (starg_tetmesh_write_options){.name = "piece"};
}

static void put_big_endian(const writer *w, uint64_t bits, int bytes) {
    unsigned char out[8] = {0};
    for (int i = 0; i < bytes; i++)
        out[i] = (unsigned char)(bits >> 8 * (bytes - 1 - i));
    fwrite(out, 1, (size_t)bytes, w->stream);
}

static void put_real(const writer *w, double value, char behind) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    if (w->binary)
        put_big_endian(w, bits, 8);
    else
        fprintf(w->stream, "%.17g%c", value, behind);
}

static void put_integer(const writer *w, int32_t value, char behind) {
    if (w->binary)
        put_big_endian(w, (uint32_t)value, 4);
    else
        fprintf(w->stream, "%ld%c", (long)value, behind);
}

/* Ends a binary block with a line end. */
static void end_block(const writer *w) {
    if (w->binary)
        fputc('\n', w->stream);
}

static void write_geometry(const writer *w, const starg_tetmesh *mesh) {
    fprintf(w->stream, "# vtk DataFile Version 3.0\nstarguard\n%s\nDATASET UNSTRUCTURED_GRID\n",
            w->binary ? "BINARY" : "ASCII");
    fprintf(w->stream, "POINTS %zu double\n", mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        put_real(w, mesh->vertices[i], i % 3 == 2 ? '\n' : ' ');
    end_block(w);
    fprintf(w->stream, "CELLS %zu %zu\n", mesh->count, 5 * mesh->count);
    for (size_t t = 0; t < mesh->count; t++) {
        put_integer(w, 4, ' ');
        for (size_t k = 0; k < 4; k++)
            put_integer(w, (int32_t)mesh->tetrahedra[4 * t + k], k == 3 ? '\n' : ' ');
    }
    end_block(w);
    fprintf(w->stream, "CELL_TYPES %zu\n", mesh->count);
    for (size_t t = 0; t < mesh->count; t++)
        put_integer(w, VTK_TETRAHEDRON, '\n');
    end_block(w);
}

static void write_labels(const writer *w, const starg_tetmesh *mesh, const int32_t *labels,
                         const char *name) {
    fprintf(w->stream, "CELL_DATA %zu\nSCALARS %s int 1\nLOOKUP_TABLE default\n", mesh->count,
            name);
    for (size_t t = 0; t < mesh->count; t++)
        put_integer(w, labels[t], '\n');
    end_block(w);
}

static void write_corners(const writer *w, const starg_tetmesh *mesh, const double *corners) {
    fprintf(w->stream, "FIELD FieldData 1\nball 12 %zu double\n", mesh->count);
    for (size_t i = 0; i < 12 * mesh->count; i++)
        put_real(w, corners[i], i % 12 == 11 ? '\n' : ' ');
    end_block(w);
}

static starg_status check_name(starg_context *context, const char *name) {
    bool good = name != NULL && *name != '\0';
    for (const char *at = name; good && *at != '\0'; at++)
        good = isgraph((unsigned char)*at) != 0;
    if (good)
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_ARGUMENT, STARG_MESH_FILE,
                      "the name of the labels must be one printable word");
}

starg_status starg_tetmesh_write(starg_context *context, const starg_tetmesh *mesh,
                                 const char *path, const starg_tetmesh_write_options *options) {
    starg_tetmesh_write_options defaults;
    starg_tetmesh_write_options_default(&defaults);
    if (options == NULL)
        options = &defaults;
    const int32_t *labels = options->labels != NULL ? options->labels : mesh->regions;
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(check_name(context, options->name));
    TRY(starg_c_locale_enter(context, &locale));
    TRY(starg_output_open(context, STARG_MESH_FILE, path, &output));
    const writer w = {output.stream, options->binary};
    write_geometry(&w, mesh);
    if (labels != NULL)
        write_labels(&w, mesh, labels, options->name);
    if (labels != NULL && options->corners != NULL)
        write_corners(&w, mesh, options->corners);
    TRY(starg_check_cancel(context, STARG_MESH_FILE));
    return starg_output_commit(&output);
}
