/* SPDX-License-Identifier: Apache-2.0 */
/* Creates a tetrahedral mesh after checking counts, coordinates, indices, orientation, neighbours
 * and overlap. Every check names the elements that fail it. */
#include "tetra/tetmesh.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "mesh/mesh.h"

static const char STAGE[] = "tetrahedra";

const int TETMESH_FACE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static starg_status check_counts(starg_context *context, size_t vertices, size_t tetrahedra) {
    if (tetrahedra == 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "there are no tetrahedra");
    if (tetrahedra > TETMESH_LIMIT || vertices > STARG_MESH_LIMIT)
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, STAGE,
            "%zu tetrahedra and %zu vertices are too many; the limits are %zu and %zu", tetrahedra,
            vertices, TETMESH_LIMIT, STARG_MESH_LIMIT);
    return STARG_OK;
}

static starg_status check_coordinates(const starg_tetmesh *mesh) {
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        if (fabs(mesh->vertices[i]) < STARG_COORDINATE_LIMIT)
            continue;
        uint64_t vertex = i / 3;
        return starg_fail_at(mesh->context, STARG_ERROR_RANGE, STAGE, STARG_ELEMENT_VERTEX, &vertex,
                             1,
                             "coordinate %c of vertex %zu is %g; coordinates must be finite and "
                             "below 1e100 in magnitude",
                             "xyz"[i % 3], i / 3, mesh->vertices[i]);
    }
    return STARG_OK;
}

static starg_status check_indices(const starg_tetmesh *mesh) {
    for (size_t i = 0; i < 4 * mesh->count; i++) {
        if (mesh->tetrahedra[i] < mesh->vertex_count)
            continue;
        uint64_t tetrahedron = i / 4;
        return starg_fail_at(
            mesh->context, STARG_ERROR_ARGUMENT, STAGE, STARG_ELEMENT_TETRAHEDRON, &tetrahedron, 1,
            "tetrahedron %zu refers to vertex %u, but there are only %zu (counted from 0)", i / 4,
            mesh->tetrahedra[i], mesh->vertex_count);
    }
    return STARG_OK;
}

/* Reverses negative tetrahedra; collects those without volume. orient3d is 1 if the fourth vertex
 * lies below the first three, which is the negative orientation here. */
static starg_status orient(starg_tetmesh *mesh) {
    uint64_t flat[STARG_ERROR_INDICES];
    size_t flat_count = 0;
    for (size_t t = 0; t < mesh->count; t++) {
        int sign = orient3d(tetmesh_corner(mesh, t, 0), tetmesh_corner(mesh, t, 1),
                            tetmesh_corner(mesh, t, 2), tetmesh_corner(mesh, t, 3));
        if (sign > 0) {
            uint32_t *v = mesh->tetrahedra + 4 * t, swap = v[2];
            v[2] = v[3];
            v[3] = swap;
            mesh->turned++;
        } else if (sign == 0) {
            if (flat_count < STARG_ERROR_INDICES)
                flat[flat_count] = t;
            flat_count++;
        }
    }
    if (flat_count > 0)
        return starg_fail_at(mesh->context, STARG_ERROR_MESH, STAGE, STARG_ELEMENT_TETRAHEDRON,
                             flat, flat_count,
                             "%zu of %zu tetrahedra have no volume (first: %llu); remove them or "
                             "generate the mesh again",
                             flat_count, mesh->count, (unsigned long long)flat[0]);
    return STARG_OK;
}

/* Identical labels carry no information. */
static void drop_uniform_regions(starg_tetmesh *mesh) {
    for (size_t t = 0; mesh->regions != NULL && t < mesh->count; t++)
        if (mesh->regions[t] != mesh->regions[0])
            return;
    starg_release(mesh->context, mesh->regions);
    mesh->regions = NULL;
}

static void tell(const starg_tetmesh *mesh) {
    if (mesh->turned > 0)
        starg_log(mesh->context, STARG_LOG_NOTICE, "reoriented %zu of %zu negative tetrahedra",
                  mesh->turned, mesh->count);
    if (mesh->regions != NULL)
        starg_log(mesh->context, STARG_LOG_NOTICE,
                  "treating several regions of tetrahedra as one solid");
}

starg_status tetmesh_adopt(starg_context *context, double *vertices, size_t vertex_count,
                           uint32_t *tetrahedra, size_t count, int32_t *regions, bool trusted,
                           starg_tetmesh **out) {
    starg_status status = STARG_OK;
    starg_tetmesh *mesh = NULL;
    *out = NULL;
    STARG_TRY(check_counts(context, vertex_count, count));
    STARG_NEW_ZERO(context, STAGE, mesh, 1);
    *mesh = (starg_tetmesh){.context = context,
                            .vertex_count = vertex_count,
                            .count = count,
                            .vertices = vertices,
                            .tetrahedra = tetrahedra};
    STARG_TRY(check_coordinates(mesh));
    STARG_TRY(check_indices(mesh));
    STARG_TRY(orient(mesh));
    STARG_TRY(tetmesh_connect(mesh));
    if (!trusted)
        STARG_TRY(tetmesh_check_overlap(mesh));
    mesh->regions = regions;
    drop_uniform_regions(mesh);
    tell(mesh);
    *out = mesh;
done:
    if (status != STARG_OK && mesh != NULL) {
        RELEASE(mesh->neighbours, mesh);
    }
    return status;
}

starg_status starg_tetmesh_create(starg_context *context, const double *vertices,
                                  size_t vertex_count, const uint32_t *tetrahedra, size_t count,
                                  const int32_t *regions, starg_tetmesh **out) {
    SCOPED double *own_vertices = NULL;
    SCOPED uint32_t *own_tetrahedra = NULL;
    SCOPED int32_t *own_regions = NULL;
    *out = NULL;
    TRY(check_counts(context, vertex_count, count));
    NEW(context, STAGE, own_vertices, 3 * vertex_count);
    NEW(context, STAGE, own_tetrahedra, 4 * count);
    memcpy(own_tetrahedra, tetrahedra, 4 * count * sizeof *tetrahedra);
    if (vertex_count > 0)
        memcpy(own_vertices, vertices, 3 * vertex_count * sizeof *vertices);
    if (regions != NULL) {
        NEW(context, STAGE, own_regions, count);
        memcpy(own_regions, regions, count * sizeof *regions);
    }
    TRY(tetmesh_adopt(context, own_vertices, vertex_count, own_tetrahedra, count, own_regions,
                      false, out));
    own_vertices = NULL;
    own_tetrahedra = NULL;
    own_regions = NULL;
    return STARG_OK;
}

starg_status tetmesh_copy(starg_context *context, const starg_tetmesh *mesh, starg_tetmesh **out) {
    SCOPED_BY(starg_tetmesh_drop) starg_tetmesh *copy = NULL;
    *out = NULL;
    NEW_ZERO(context, STAGE, copy, 1);
    copy->context = context;
    copy->vertex_count = mesh->vertex_count;
    copy->count = mesh->count;
    copy->turned = mesh->turned;
    NEW(context, STAGE, copy->vertices, 3 * mesh->vertex_count);
    NEW(context, STAGE, copy->tetrahedra, 4 * mesh->count);
    NEW(context, STAGE, copy->neighbours, 4 * mesh->count);
    memcpy(copy->vertices, mesh->vertices, 3 * mesh->vertex_count * sizeof *mesh->vertices);
    memcpy(copy->tetrahedra, mesh->tetrahedra, 4 * mesh->count * sizeof *mesh->tetrahedra);
    memcpy(copy->neighbours, mesh->neighbours, 4 * mesh->count * sizeof *mesh->neighbours);
    *out = copy;
    copy = NULL;
    return STARG_OK;
}

void starg_tetmesh_free(starg_tetmesh *mesh) {
    if (mesh == NULL)
        return;
    RELEASE(mesh->vertices, mesh->tetrahedra, mesh->neighbours, mesh->regions, mesh->corners, mesh);
}

size_t starg_tetmesh_vertex_count(const starg_tetmesh *mesh) {
    return mesh->vertex_count;
}

size_t starg_tetmesh_count(const starg_tetmesh *mesh) {
    return mesh->count;
}

const double *starg_tetmesh_vertices(const starg_tetmesh *mesh) {
    return mesh->vertices;
}

const uint32_t *starg_tetmesh_tetrahedra(const starg_tetmesh *mesh) {
    return mesh->tetrahedra;
}

const uint32_t *starg_tetmesh_neighbours(const starg_tetmesh *mesh) {
    return mesh->neighbours;
}

const int32_t *starg_tetmesh_regions(const starg_tetmesh *mesh) {
    return mesh->regions;
}

size_t starg_tetmesh_turned(const starg_tetmesh *mesh) {
    return mesh->turned;
}

int tetmesh_exponent(const starg_tetmesh *mesh) {
    double extent = 0;
    int exponent;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        extent = fmax(extent, fabs(mesh->vertices[i] - mesh->vertices[i % 3]));
    frexp(extent, &exponent);
    return exponent + 1; /* between any two vertices it may be twice that from the first */
}

double tetmesh_scaled_volume(const starg_tetmesh *mesh, size_t tetrahedron, int exponent) {
    double edge[3][3];
    for (int k = 0; k < 3; k++) {
        vec3_subtract(tetmesh_corner(mesh, tetrahedron, k + 1),
                      tetmesh_corner(mesh, tetrahedron, 0), edge[k]);
        for (int i = 0; i < 3; i++)
            edge[k][i] = ldexp(edge[k][i], -exponent);
    }
    return vec3_triple(edge[0], edge[1], edge[2]);
}

double starg_tetmesh_volume(const starg_tetmesh *mesh) {
    double sum = 0;
    int exponent = tetmesh_exponent(mesh);
    for (size_t t = 0; t < mesh->count; t++)
        sum += tetmesh_scaled_volume(mesh, t, exponent);
    return ldexp(sum / 6, 3 * exponent);
}

/* Flatness of tetrahedra: least height over longest edge, 0.816 for the regular one and 0 without
 * volume. Rounded; decides nothing. */

static double flatness(const starg_tetmesh *mesh, size_t tetrahedron) {
    const double *p[4];
    double longest = 0, largest = 0, edge[3][3];
    for (int k = 0; k < 4; k++)
        p[k] = tetmesh_corner(mesh, tetrahedron, k);
    for (int i = 0; i < 4; i++)
        for (int k = i + 1; k < 4; k++)
            longest = fmax(longest, vec3_distance(p[i], p[k]));
    if (longest == 0)
        return 0;
    /* in units of the longest edge, to avoid overflow and underflow */
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++)
            edge[k][c] = (p[k + 1][c] - p[0][c]) / longest;
    double volume = fabs(vec3_triple(edge[0], edge[1], edge[2])) / 6;
    const double origin[3] = {0, 0, 0};
    largest = fmax(vec3_triangle_area(origin, edge[0], edge[1]),
                   vec3_triangle_area(origin, edge[1], edge[2]));
    largest = fmax(largest, fmax(vec3_triangle_area(origin, edge[2], edge[0]),
                                 vec3_triangle_area(edge[0], edge[1], edge[2])));
    return largest > 0 ? 3 * volume / largest : 0;
}

double tetmesh_flattest(const starg_tetmesh *mesh) {
    double least = 1;
    for (size_t t = 0; t < mesh->count; t++)
        least = fmin(least, flatness(mesh, t));
    return least;
}
