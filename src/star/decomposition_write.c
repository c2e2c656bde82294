/* SPDX-License-Identifier: Apache-2.0 */
/* PIECES.vtk and PIECES.json: a decomposition as text (docs/formats.md). */
#include "core/record.h"
#include "star/decomposition.h"
#include "tetra/tetmesh.h"

static const char STAGE[] = "pieces file";

starg_status starg_decomposition_write(starg_context *context,
                                       const starg_decomposition *decomposition, const char *path,
                                       bool binary) {
    starg_tetmesh_write_options options;
    starg_tetmesh_write_options_default(&options);
    options.binary = binary;
    options.labels = decomposition->labels;
    options.corners = decomposition->ball_corners;
    return starg_tetmesh_write(context, decomposition->mesh, path, &options);
}

static bool put(FILE *stream, const void *result, const char *model_file) {
    starg_decomposition shown = *(const starg_decomposition *)result;
    shown.file = (char *)(uintptr_t)model_file;
    return record_put(stream, &decomposition_file_fields, &shown, 0);
}

starg_status starg_decomposition_write_report(starg_context *context,
                                              const starg_decomposition *decomposition,
                                              const char *model_file, const char *path) {
    return starg_json_write(context, STAGE, path, put, decomposition, model_file);
}

starg_status starg_decomposition_write_report_memory(starg_context *context,
                                                     const starg_decomposition *decomposition,
                                                     const char *model_file, char **text,
                                                     size_t *size) {
    return starg_json_write_memory(context, STAGE, put, decomposition, model_file, text, size);
}
