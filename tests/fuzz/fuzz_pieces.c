/* Any bytes as PIECES.vtk and as PIECES.json: read or rejected with a message, nothing lost; what
 * can be read is verified against a tetrahedron, whatever the verdict. */
#include <stdbool.h>
#include <stdlib.h>

#include "starguard/verify.h"

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

static starg_mesh *make_model(starg_context *context) {
    static const double vertices[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    starg_mesh *model = NULL;
    if (starg_mesh_create(context, vertices, 4, faces, 4, &model) != STARG_OK)
        abort();
    return model;
}

/* One piece about the middle, as far as it goes. */
static void verify(starg_context *context, const starg_pieces_mesh *mesh) {
    starg_piece piece = {.guard = {0.25, 0.25, 0.25}, .tetrahedra = mesh->count, .star = true};
    const starg_pieces_report report = {.mode = STARG_DECOMPOSE_PAPER,
                                        .tetrahedra = mesh->count,
                                        .piece_count = 1,
                                        .pieces = &piece,
                                        .strictly_star = 1};
    starg_mesh *model = make_model(context);
    starg_verdict *verdict = NULL;
    if (starg_verify_pieces(context, model, mesh, &report, &verdict) != STARG_OK)
        abort();
    starg_verdict_free(context, verdict);
    starg_mesh_free(model);
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
    starg_context *context = NULL;
    starg_pieces_mesh *mesh = NULL;
    starg_pieces_report *report = NULL;
    if (starg_context_create(NULL, &context) != STARG_OK)
        return 0;
    bool read = starg_pieces_mesh_read_memory(context, data, size, "fuzz", &mesh) == STARG_OK;
    bool told = read || starg_context_error(context)->message[0] != '\0';
    if (read)
        verify(context, mesh);
    read = starg_pieces_report_read_memory(context, data, size, "fuzz", &report) == STARG_OK;
    told = told && (read || starg_context_error(context)->message[0] != '\0');
    starg_pieces_mesh_free(context, mesh);
    starg_pieces_report_free(context, report);
    if (!told || starg_context_live_blocks(context) != 0)
        abort();
    starg_context_free(context);
    return 0;
}
