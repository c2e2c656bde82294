/* SPDX-License-Identifier: Apache-2.0 */
/* STL: each triangle with its normal and its three points. Binary STL holds single precision. */
#include "geometry/vec3.h"
#include "mesh/formats/io.h"

/* The three points of a face and its unit normal, zero for a zero-area face. */
static void look_up(const starg_mesh *mesh, size_t face, double points[3][3], double normal[3]) {
    for (int corner = 0; corner < 3; corner++)
        vec3_copy(mesh->vertices + 3 * (size_t)mesh->faces[3 * face + (size_t)corner],
                  points[corner]);
    double scale = 0, u[3], v[3];
    vec3_subtract(points[1], points[0], u);
    vec3_subtract(points[2], points[0], v);
    for (int k = 0; k < 3; k++)
        scale = fmax(scale, fmax(fabs(u[k]), fabs(v[k])));
    for (int k = 0; k < 3 && scale > 0; k++) { /* avoids overflow and underflow of products */
        u[k] /= scale;
        v[k] /= scale;
    }
    vec3_cross(u, v, normal);
    double length = vec3_length(normal);
    for (int k = 0; k < 3; k++)
        normal[k] = length > 0 ? normal[k] / length : 0;
}

void starg_stl_write_ascii(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    bool noted = extras->note[0] != '\0';
    fprintf(stream, "solid starguard%s%s\n", noted ? " " : "", extras->note);
    for (size_t i = 0; i < mesh->face_count; i++) {
        double points[3][3], n[3];
        look_up(mesh, i, points, n);
        fprintf(stream, "facet normal %.17g %.17g %.17g\nouter loop\n", n[0], n[1], n[2]);
        for (int corner = 0; corner < 3; corner++)
            fprintf(stream, "vertex %.17g %.17g %.17g\n", points[corner][0], points[corner][1],
                    points[corner][2]);
        fputs("endloop\nendfacet\n", stream);
    }
    fputs("endsolid starguard\n", stream);
}

void starg_stl_write_binary(FILE *stream, const starg_mesh *mesh, const starg_mesh_extras *extras) {
    enum { HEADER = 80, RECORD = 50 };
    unsigned char header[HEADER + 4] = {0};
    memcpy(header, extras->note, strnlen(extras->note, HEADER));
    pack_u32(header + HEADER, (uint32_t)mesh->face_count);
    fwrite(header, 1, sizeof header, stream);
    for (size_t i = 0; i < mesh->face_count; i++) {
        unsigned char record[RECORD] = {0};
        double points[3][3], normal[3];
        look_up(mesh, i, points, normal);
        for (size_t k = 0; k < 3; k++)
            pack_f32(record + 4 * k, (float)normal[k]);
        for (size_t corner = 0; corner < 3; corner++)
            for (size_t k = 0; k < 3; k++)
                pack_f32(record + 12 + 12 * corner + 4 * k, (float)points[corner][k]);
        fwrite(record, 1, sizeof record, stream);
    }
}
