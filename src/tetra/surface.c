/* SPDX-License-Identifier: Apache-2.0 */
/* The boundary of a tetrahedral mesh: the faces of a single tetrahedron. */
#include "mesh/mesh.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "tetrahedra";

/* Lists boundary faces with the mesh's vertex numbers; marks the vertices used. */
static size_t collect_faces(const starg_tetmesh *mesh, uint32_t *faces, uint32_t *numbers) {
    size_t count = 0;
    for (size_t f = 0; f < 4 * mesh->count; f++) {
        if (mesh->neighbours[f] != STARG_TETMESH_NONE)
            continue;
        for (int k = 0; k < 3; k++) {
            uint32_t v = mesh->tetrahedra[(f & ~(size_t)3) + (size_t)TETMESH_FACE[f & 3][k]];
            faces[3 * count + (size_t)k] = v;
            numbers[v] = 0;
        }
        count++;
    }
    return count;
}

static size_t count_faces(const starg_tetmesh *mesh) {
    size_t count = 0;
    for (size_t f = 0; f < 4 * mesh->count; f++)
        count += mesh->neighbours[f] == STARG_TETMESH_NONE;
    return count;
}

/* Numbers the marked vertices in order; `map` receives their old numbers. */
static size_t number_vertices(const starg_tetmesh *mesh, uint32_t *numbers, uint32_t *map) {
    size_t count = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        if (numbers[v] == 0) {
            numbers[v] = (uint32_t)count;
            map[count++] = (uint32_t)v;
        }
    return count;
}

starg_status starg_tetmesh_surface(starg_context *context, const starg_tetmesh *mesh,
                                   starg_mesh **out, uint32_t **vertex_map) {
    SCOPED uint32_t *faces = NULL, *numbers = NULL, *map = NULL;
    SCOPED double *vertices = NULL;
    *out = NULL;
    if (vertex_map != NULL)
        *vertex_map = NULL;
    NEW(context, STAGE, faces, 3 * count_faces(mesh));
    NEW(context, STAGE, numbers, mesh->vertex_count);
    NEW(context, STAGE, map, mesh->vertex_count);
    memset(numbers, 0xff, mesh->vertex_count * sizeof *numbers);
    size_t face_count = collect_faces(mesh, faces, numbers);
    size_t vertex_count = number_vertices(mesh, numbers, map);
    NEW(context, STAGE, vertices, 3 * vertex_count);
    for (size_t v = 0; v < vertex_count; v++)
        memcpy(vertices + 3 * v, mesh->vertices + 3 * (size_t)map[v], 3 * sizeof *vertices);
    for (size_t i = 0; i < 3 * face_count; i++)
        faces[i] = numbers[faces[i]];
    TRY(starg_mesh_adopt(context, vertices, vertex_count, faces, face_count, out));
    faces = NULL;
    vertices = NULL;
    if (vertex_map != NULL) {
        *vertex_map = map;
        map = NULL;
    }
    return STARG_OK;
}

void starg_tetmesh_map_free(starg_context *context, uint32_t *vertex_map) {
    starg_release(context, vertex_map);
}
