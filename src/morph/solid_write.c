/* SPDX-License-Identifier: Apache-2.0 */
/* MAP.vtu: a map between solids as a VTK XML unstructured grid, with numbers as text
 * (docs/formats.md): tetrahedra at their places in A, and the places in B as a vector of points. */
#include <inttypes.h>

#include "core/file.h"
#include "morph/solid_map.h"

static const char STAGE[] = "map file";

enum { VTK_TETRAHEDRON = 10, COLUMNS = 20, KEY_NAME = 32 };

static void put_reals(FILE *stream, const double *values, size_t rows, size_t columns) {
    for (size_t i = 0; i < rows * columns; i++)
        fprintf(stream, "%.17g%c", values[i], (i + 1) % columns == 0 ? '\n' : ' ');
}

static void open_array(FILE *stream, const char *type, const char *name, size_t components) {
    fprintf(stream,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%zu\" format=\"ascii\">\n",
            type, name, components);
}

/* An array of FieldData says how many rows it has. */
static void put_field(FILE *stream, const char *name, const double *values, size_t rows,
                      size_t columns) {
    fprintf(stream,
            "<DataArray type=\"Float64\" Name=\"%s\" NumberOfComponents=\"%zu\" "
            "NumberOfTuples=\"%zu\" format=\"ascii\">\n",
            name, columns, rows);
    put_reals(stream, values, rows, columns);
    fputs("</DataArray>\n", stream);
}

static void put_points(FILE *stream, const char *name, const double *values, size_t rows) {
    open_array(stream, "Float64", name, 3);
    put_reals(stream, values, rows, 3);
    fputs("</DataArray>\n", stream);
}

static void put_cells(FILE *stream, const starg_solid_map *map) {
    fputs("<Cells>\n", stream);
    open_array(stream, "Int64", "connectivity", 1);
    for (size_t i = 0; i < 4 * map->count; i++)
        fprintf(stream, "%" PRIu32 "%c", map->tetrahedra[i], i % 4 == 3 ? '\n' : ' ');
    fputs("</DataArray>\n", stream);
    open_array(stream, "Int64", "offsets", 1);
    for (size_t t = 0; t < map->count; t++)
        fprintf(stream, "%zu%c", 4 * (t + 1), (t + 1) % COLUMNS == 0 ? '\n' : ' ');
    fputs("</DataArray>\n", stream);
    open_array(stream, "UInt8", "types", 1);
    for (size_t t = 0; t < map->count; t++)
        fprintf(stream, "%d%c", VTK_TETRAHEDRON, (t + 1) % COLUMNS == 0 ? '\n' : ' ');
    fputs("</DataArray>\n</Cells>\n", stream);
}

static void put_cell_data(FILE *stream, const starg_solid_map *map) {
    int exponents[2];
    solid_map_exponents(map, exponents);
    fputs("<CellData Scalars=\"piece\">\n", stream);
    open_array(stream, "Int32", "piece", 1);
    for (size_t t = 0; t < map->count; t++)
        fprintf(stream, "%" PRId32 "%c", map->labels[t], (t + 1) % COLUMNS == 0 ? '\n' : ' ');
    fputs("</DataArray>\n", stream);
    open_array(stream, "Float64", "ratio", 1);
    for (size_t t = 0; t < map->count; t++) {
        double volume;
        fprintf(stream, "%.17g\n", solid_map_ratio(map, t, exponents, &volume));
    }
    fputs("</DataArray>\n</CellData>\n", stream);
}

starg_status starg_solid_map_write(starg_context *context, const starg_solid_map *map,
                                   const char *path) {
    starg_output output;
    const double distortion[3] = {map->worst, map->mean, map->above_10};
    const double missed[3] = {map->distance, map->distance_back, map->missing};
    TRY(starg_output_open(context, STAGE, path, &output));
    FILE *stream = output.stream;
    fprintf(stream, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                    "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n"
                    "<FieldData>\n");
    put_field(stream, "distortion", distortion, 1, 3);
    put_field(stream, "guard", map->guards, map->piece_count, 3);
    put_field(stream, "guard_image", map->guard_images, map->piece_count, 3);
    if (map->compared)
        put_field(stream, "missed", missed, 1, 3);
    if (map->key_count > 0)
        put_field(stream, "time", map->times, map->key_count, 1);
    fprintf(stream,
            "</FieldData>\n<Piece NumberOfPoints=\"%zu\" NumberOfCells=\"%zu\">\n"
            "<PointData Vectors=\"image\">\n",
            map->vertex_count, map->count);
    put_points(stream, "image", map->images, map->vertex_count);
    for (size_t key = 0; key < map->key_count; key++) {
        char name[KEY_NAME];
        snprintf(name, sizeof name, "key_%04zu", key);
        put_points(stream, name, map->keys + 3 * key * map->vertex_count, map->vertex_count);
    }
    fputs("</PointData>\n", stream);
    put_cell_data(stream, map);
    fputs("<Points>\n", stream);
    put_points(stream, "Points", map->vertices, map->vertex_count);
    fputs("</Points>\n", stream);
    put_cells(stream, map);
    fputs("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", stream);
    return starg_output_commit(&output);
}
