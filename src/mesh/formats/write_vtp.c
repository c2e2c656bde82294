/* SPDX-License-Identifier: Apache-2.0 */
/* VTK XML polydata, arrays appended raw, each behind its length in 8 bytes: double coordinates,
 * triangles, and as data of cells `color` (red, green, blue) and `mark`, where there are any. */
#include "mesh/formats/io.h"

static void put_u64(FILE *stream, uint64_t value) {
    unsigned char bytes[8];
    pack_u32(bytes, (uint32_t)value);
    pack_u32(bytes + 4, (uint32_t)(value >> 32));
    fwrite(bytes, 1, sizeof bytes, stream);
}

static void put_u32s(FILE *stream, const uint32_t *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        unsigned char bytes[4];
        pack_u32(bytes, values[i]);
        fwrite(bytes, 1, sizeof bytes, stream);
    }
}

static void put_array(FILE *stream, const char *type, const char *name, int components,
                      uint64_t size, uint64_t *offset) {
    fprintf(stream,
            "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" "
            "offset=\"%llu\"/>\n",
            type, name, components, (unsigned long long)*offset);
    *offset += 8 + size;
}

void starg_vtp_write(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    uint64_t faces = mesh->face_count, offset = 0;
    fprintf(stream,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
            "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
            "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
            "NumberOfStrips=\"0\" NumberOfPolys=\"%zu\">\n<CellData>\n",
            mesh->vertex_count, mesh->face_count);
    if (extras->colors != NULL)
        put_array(stream, "UInt8", "color", 3, 3 * faces, &offset);
    if (extras->marks != NULL)
        put_array(stream, "Int32", "mark", 1, 4 * faces, &offset);
    fputs("</CellData>\n<Points>\n", stream);
    put_array(stream, "Float64", "Points", 3, 24 * (uint64_t)mesh->vertex_count, &offset);
    fputs("</Points>\n<Polys>\n", stream);
    put_array(stream, "UInt32", "connectivity", 1, 12 * faces, &offset);
    put_array(stream, "Int64", "offsets", 1, 8 * faces, &offset);
    fputs("</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", stream);
    if (extras->colors != NULL) {
        put_u64(stream, 3 * faces);
        fwrite(extras->colors, 3, mesh->face_count, stream);
    }
    if (extras->marks != NULL) {
        put_u64(stream, 4 * faces);
        put_u32s(stream, (const uint32_t *)extras->marks, mesh->face_count);
    }
    put_u64(stream, 24 * (uint64_t)mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        unsigned char bytes[8];
        pack_f64(bytes, mesh->vertices[i]);
        fwrite(bytes, 1, sizeof bytes, stream);
    }
    put_u64(stream, 12 * faces);
    put_u32s(stream, mesh->faces, 3 * mesh->face_count);
    put_u64(stream, 8 * faces);
    for (size_t i = 0; i < mesh->face_count; i++)
        put_u64(stream, 3 * ((uint64_t)i + 1));
    fputs("\n</AppendedData>\n</VTKFile>\n", stream);
}
