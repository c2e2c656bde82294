/* Inside of a mesh. */
#ifndef STARG_MESH_MESH_H
#define STARG_MESH_MESH_H

#include "core/context.h"
#include "starguard/mesh.h"

struct starg_mesh {
    starg_context *context;
    size_t vertex_count, face_count;
    double *vertices; /* vertex_count x 3 */
    uint32_t *faces;  /* face_count x 3   */
};

/* Largest number of vertices or faces. */
#define STARG_MESH_LIMIT ((size_t)0x7fffffff)

/* Every coordinate is smaller in magnitude. */
#define STARG_COORDINATE_LIMIT 1e100

/* Takes over two blocks of the context (on success only), after the checks of starg_mesh_create. */
starg_status starg_mesh_adopt(starg_context *context, double *vertices, size_t vertex_count,
                              uint32_t *faces, size_t face_count, starg_mesh **out);

#endif
