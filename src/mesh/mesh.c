/* SPDX-License-Identifier: Apache-2.0 */
#include "mesh/mesh.h"

#include "geometry/vec3.h"

static starg_status check_counts(starg_context *context, size_t vertex_count, size_t face_count) {
    if (vertex_count > STARG_MESH_LIMIT || face_count > STARG_MESH_LIMIT)
        return starg_fail(context, STARG_ERROR_ARGUMENT, "mesh",
                          "%zu vertices and %zu faces are too many; the limit is 2147483647 each",
                          vertex_count, face_count);
    return STARG_OK;
}

static starg_status check_vertices(starg_context *context, const double *vertices, size_t count) {
    for (size_t i = 0; i < 3 * count; i++) {
        if (fabs(vertices[i]) < STARG_COORDINATE_LIMIT)
            continue; /* also for NaN */
        uint64_t vertex = i / 3;
        return starg_fail_at(context, STARG_ERROR_RANGE, "mesh", STARG_ELEMENT_VERTEX, &vertex, 1,
                             "coordinate %c of vertex %zu is %g; coordinates must be finite and "
                             "below 1e100 in magnitude",
                             "xyz"[i % 3], i / 3, vertices[i]);
    }
    return STARG_OK;
}

static starg_status check_faces(starg_context *context, const uint32_t *faces, size_t face_count,
                                size_t vertex_count) {
    for (size_t i = 0; i < 3 * face_count; i++) {
        if (faces[i] < vertex_count)
            continue;
        uint64_t face = i / 3;
        return starg_fail_at(context, STARG_ERROR_ARGUMENT, "mesh", STARG_ELEMENT_FACE, &face, 1,
                             "face %zu refers to vertex %u, but there are only %zu vertices", i / 3,
                             faces[i], vertex_count);
    }
    return STARG_OK;
}

starg_status starg_mesh_adopt(starg_context *context, double *vertices, size_t vertex_count,
                              uint32_t *faces, size_t face_count, starg_mesh **out) {
    starg_mesh *mesh = NULL;
    *out = NULL;
    TRY(check_counts(context, vertex_count, face_count));
    TRY(check_vertices(context, vertices, vertex_count));
    TRY(check_faces(context, faces, face_count, vertex_count));
    NEW(context, "mesh", mesh, 1);
    *mesh = (starg_mesh){.context = context,
                         .vertex_count = vertex_count,
                         .face_count = face_count,
                         .vertices = vertices,
                         .faces = faces};
    *out = mesh;
    return STARG_OK;
}

starg_status starg_mesh_create(starg_context *context, const double *vertices, size_t vertex_count,
                               const uint32_t *faces, size_t face_count, starg_mesh **out) {
    SCOPED double *own_vertices = NULL;
    SCOPED uint32_t *own_faces = NULL;
    *out = NULL;
    TRY(check_counts(context, vertex_count, face_count));
    NEW(context, "mesh", own_vertices, 3 * vertex_count);
    NEW(context, "mesh", own_faces, 3 * face_count);
    if (vertex_count != 0)
        memcpy(own_vertices, vertices, 3 * vertex_count * sizeof *vertices);
    if (face_count != 0)
        memcpy(own_faces, faces, 3 * face_count * sizeof *faces);
    TRY(starg_mesh_adopt(context, own_vertices, vertex_count, own_faces, face_count, out));
    own_vertices = NULL;
    own_faces = NULL;
    return STARG_OK;
}

void starg_mesh_free(starg_mesh *mesh) {
    if (mesh == NULL)
        return;
    RELEASE(mesh->vertices, mesh->faces, mesh->colors, mesh->texture, mesh);
}

size_t starg_mesh_vertex_count(const starg_mesh *mesh) {
    return mesh->vertex_count;
}

size_t starg_mesh_face_count(const starg_mesh *mesh) {
    return mesh->face_count;
}

const uint8_t *starg_mesh_colors(const starg_mesh *mesh) {
    return mesh->colors;
}

starg_status starg_mesh_set_colors(starg_mesh *mesh, const uint8_t *colors) {
    uint8_t *own = NULL;
    if (colors != NULL) {
        NEW(mesh->context, "mesh", own, 3 * mesh->vertex_count);
        memcpy(own, colors, 3 * mesh->vertex_count);
    }
    starg_release(mesh->context, mesh->colors);
    mesh->colors = own;
    return STARG_OK;
}

const float *starg_mesh_texture(const starg_mesh *mesh) {
    return mesh->texture;
}

starg_status starg_mesh_set_texture(starg_mesh *mesh, const float *texture) {
    float *own = NULL;
    if (texture != NULL) {
        NEW(mesh->context, "mesh", own, 6 * mesh->face_count);
        memcpy(own, texture, 6 * mesh->face_count * sizeof *own);
    }
    starg_release(mesh->context, mesh->texture);
    mesh->texture = own;
    return STARG_OK;
}

unsigned starg_mesh_left_out(const starg_mesh *mesh) {
    return mesh->left_out;
}

const double *starg_mesh_vertices(const starg_mesh *mesh) {
    return mesh->vertices;
}

const uint32_t *starg_mesh_faces(const starg_mesh *mesh) {
    return mesh->faces;
}

void starg_mesh_bounds(const starg_mesh *mesh, double lower[3], double upper[3]) {
    for (int k = 0; k < 3; k++)
        lower[k] = upper[k] = mesh->vertex_count ? mesh->vertices[k] : 0;
    for (size_t i = 3; i < 3 * mesh->vertex_count; i++) {
        double x = mesh->vertices[i];
        if (x < lower[i % 3])
            lower[i % 3] = x;
        if (x > upper[i % 3])
            upper[i % 3] = x;
    }
}

static double extent_of(const starg_mesh *mesh) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    return fmax(upper[0] - lower[0], fmax(upper[1] - lower[1], upper[2] - lower[2]));
}

bool mesh_is_wide(const starg_mesh *mesh) {
    double extent = extent_of(mesh);
    return extent == 0 || extent >= STARG_EXTENT_LEAST;
}

starg_status mesh_check_extent(starg_context *context, const starg_mesh *mesh, const char *stage) {
    if (mesh_is_wide(mesh))
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_RANGE, stage,
                      "the model is only %.3g wide; areas and volumes below a width of %g "
                      "underflow: scale its coordinates, by a power of two to keep them exact",
                      extent_of(mesh), STARG_EXTENT_LEAST);
}

/* Multiples of a power of two at least as large as the extent: differences from them need no more
 * bits than the coordinates have. */
void starg_mesh_origin(const starg_mesh *mesh, double origin[3]) {
    double lower[3], upper[3], step = ldexp(1, starg_mesh_exponent(mesh));
    starg_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        double middle = 0.5 * lower[k] + 0.5 * upper[k];
        origin[k] = mesh->vertex_count > 0 ? trunc(middle / step) * step : 0;
    }
}

double mesh_diagonal(const starg_mesh *mesh) {
    double lower[3], upper[3];
    starg_mesh_bounds(mesh, lower, upper);
    return hypot(hypot(upper[0] - lower[0], upper[1] - lower[1]), upper[2] - lower[2]);
}

double mesh_shortest_edge(const starg_mesh *mesh) {
    double least = INFINITY;
    for (size_t h = 0; h < 3 * mesh->face_count; h++) {
        const double *p = mesh->vertices + 3 * (size_t)mesh->faces[h];
        const double *q = mesh->vertices + 3 * (size_t)mesh->faces[h % 3 < 2 ? h + 1 : h - 2];
        double length = hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]);
        if (length > 0)
            least = fmin(least, length);
    }
    return least;
}

int starg_mesh_exponent(const starg_mesh *mesh) {
    int exponent;
    frexp(extent_of(mesh), &exponent);
    return exponent;
}

void starg_mesh_scaled_corner(const starg_mesh *mesh, size_t face, size_t k, int exponent,
                              double out[3]) {
    vec3_subtract(mesh->vertices + 3 * (size_t)mesh->faces[3 * face + k], mesh->vertices, out);
    for (int i = 0; i < 3; i++)
        out[i] = ldexp(out[i], -exponent);
}

double starg_mesh_area(const starg_mesh *mesh) {
    double sum = 0;
    int exponent = starg_mesh_exponent(mesh);
    for (size_t f = 0; f < mesh->face_count; f++) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++)
            starg_mesh_scaled_corner(mesh, f, k, exponent, p[k]);
        sum += vec3_triangle_area(p[0], p[1], p[2]);
    }
    return ldexp(sum, 2 * exponent);
}

double starg_mesh_volume(const starg_mesh *mesh) {
    double sum = 0;
    int exponent = starg_mesh_exponent(mesh);
    for (size_t f = 0; f < mesh->face_count; f++) {
        double p[3][3]; /* relative to the first vertex, for precision */
        for (size_t k = 0; k < 3; k++)
            starg_mesh_scaled_corner(mesh, f, k, exponent, p[k]);
        sum += vec3_triple(p[0], p[1], p[2]);
    }
    return ldexp(sum / 6, 3 * exponent);
}
