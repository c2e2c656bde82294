/* SPDX-License-Identifier: Apache-2.0 */
/* The closed surfaces of all pieces in one mesh or one file: the faces of each with vertices of its
 * own, which are numbered in the order in which its faces name them. Cost: O(n). */
#include "geometry/vec3.h"
#include "mesh/formats/io.h"
#include "star/decomposition.h"
#include "star/piece_faces.h"

static const char STAGE[] = "pieces";

/* Numbers the vertices anew, those of every piece apart; `owner` and `number` belong to the
 * vertices of the mesh. Returns how many there are. */
static size_t number_vertices(const piece_faces *faces, uint32_t *owner, uint32_t *number,
                              uint32_t *corners, double *vertices) {
    size_t count = 0;
    for (size_t p = 0; p < faces->piece_count; p++)
        for (size_t i = 3 * faces->first[p]; i < 3 * faces->first[p + 1]; i++) {
            uint32_t v = faces->corners[i];
            if (owner[v] != p) {
                owner[v] = (uint32_t)p;
                number[v] = (uint32_t)count;
                vec3_copy(faces->vertices + 3 * (size_t)v, vertices + 3 * count++);
            }
            corners[i] = number[v];
        }
    return count;
}

static starg_status copy_first(starg_context *context, const piece_faces *faces, uint32_t **out) {
    NEW(context, STAGE, *out, faces->piece_count + 1);
    for (size_t p = 0; p <= faces->piece_count; p++)
        (*out)[p] = (uint32_t)faces->first[p];
    return STARG_OK;
}

starg_status starg_decomposition_surfaces(starg_context *context,
                                          const starg_decomposition *decomposition,
                                          starg_mesh **out, uint32_t **first_face) {
    const starg_tetmesh *mesh = decomposition->mesh;
    SCOPED_BY(piece_faces_free) piece_faces faces = {0};
    SCOPED uint32_t *owner = NULL, *number = NULL, *corners = NULL, *first = NULL;
    SCOPED double *vertices = NULL;
    *out = NULL;
    *first_face = NULL;
    TRY(piece_faces_create(context, mesh, decomposition->labels, decomposition->piece_count,
                           &faces));
    size_t face_count = faces.first[faces.piece_count];
    if (face_count > STARG_MESH_LIMIT / 3)
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "the pieces have %zu faces, more than can be numbered in one mesh",
                          face_count);
    NEW(context, STAGE, owner, mesh->vertex_count);
    NEW(context, STAGE, number, mesh->vertex_count);
    NEW(context, STAGE, corners, 3 * face_count);
    NEW(context, STAGE, vertices, 9 * face_count);
    memset(owner, 0xff, mesh->vertex_count * sizeof *owner);
    size_t vertex_count = number_vertices(&faces, owner, number, corners, vertices);
    TRY(copy_first(context, &faces, &first));
    TRY(starg_mesh_adopt(context, vertices, vertex_count, corners, face_count, out));
    vertices = NULL;
    corners = NULL;
    *first_face = first;
    first = NULL;
    return STARG_OK;
}

/* ---- file ---- */

static void write_groups(FILE *stream, const starg_mesh *mesh, const uint32_t *first,
                         size_t piece_count) {
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->vertices + 3 * v;
        fprintf(stream, "v %.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (size_t p = 0; p < piece_count; p++) {
        fprintf(stream, "g piece_%04zu\n", p);
        for (size_t f = first[p]; f < first[p + 1]; f++) {
            const uint32_t *c = mesh->faces + 3 * f;
            fprintf(stream, "f %lu %lu %lu\n", c[0] + 1UL, c[1] + 1UL, c[2] + 1UL);
        }
    }
}

starg_status starg_decomposition_write_groups(starg_context *context,
                                              const starg_decomposition *decomposition,
                                              const char *path) {
    SCOPED_BY(starg_mesh_drop) starg_mesh *mesh = NULL;
    SCOPED uint32_t *first = NULL;
    SCOPED_BY(starg_output_discard) starg_output output = {0};
    SCOPED_BY(starg_c_locale_leave) starg_c_locale locale = {0};
    TRY(starg_decomposition_surfaces(context, decomposition, &mesh, &first));
    TRY(starg_c_locale_enter(context, &locale));
    TRY(starg_output_open(context, STAGE, path, &output));
    write_groups(output.stream, mesh, first, decomposition->piece_count);
    TRY(starg_check_cancel(context, STAGE));
    return starg_output_commit(&output);
}
