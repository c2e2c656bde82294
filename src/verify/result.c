/* SPDX-License-Identifier: Apache-2.0 */
/* Recognizes the kind of a result file by its content. */
#include <jansson.h>

#include "core/file.h"
#include "core/memory.h"
#include "starguard/verify.h"

STARG_DROP_RESULT(starg_result)

static const char STAGE[] = "result file";

/* Is it JSON with this "format"? */
static bool has_format(const char *bytes, size_t size, const char *format) {
    json_t *root = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, NULL);
    const char *found = json_string_value(json_object_get(root, "format"));
    bool same = found != NULL && strcmp(found, format) == 0;
    json_decref(root);
    return same;
}

static bool begins_with(const char *bytes, size_t size, const char *magic) {
    size_t length = strlen(magic);
    return size >= length && memcmp(bytes, magic, length) == 0;
}

static starg_status read_bytes(starg_context *context, const char *bytes, size_t size,
                               const char *name, starg_result *result) {
    if (begins_with(bytes, size, "starguard-certificate"))
        return starg_certificate_read_memory(context, bytes, size, name, &result->certificate);
    if (begins_with(bytes, size, "# vtk"))
        return starg_pieces_mesh_read_memory(context, bytes, size, name, &result->pieces);
    if (begins_with(bytes, size, "<?xml") || begins_with(bytes, size, "<VTKFile"))
        return starg_solid_map_read_memory(context, bytes, size, name, &result->solid_map);
    if (has_format(bytes, size, "starguard-pieces"))
        return starg_pieces_report_read_memory(context, bytes, size, name, &result->report);
    if (has_format(bytes, size, "starguard-map"))
        return starg_map_file_read_memory(context, bytes, size, name, &result->map);
    if (has_format(bytes, size, "starguard-morph"))
        return starg_morph_report_read_memory(context, bytes, size, name, &result->morph);
    return starg_guards_read_memory(context, bytes, size, name, &result->guards);
}

starg_status starg_result_read(starg_context *context, const char *path, starg_result **out) {
    SCOPED_BY(starg_result_drop) starg_result *result = NULL;
    SCOPED char *bytes = NULL;
    size_t size;
    *out = NULL;
    NEW_ZERO(context, STAGE, result, 1);
    TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    TRY(read_bytes(context, bytes, size, path, result));
    *out = result;
    result = NULL;
    return STARG_OK;
}

void starg_result_free(starg_context *context, starg_result *result) {
    (void)context;
    if (result == NULL)
        return;
    starg_guards_free(NULL, result->guards);
    starg_pieces_mesh_free(NULL, result->pieces);
    starg_pieces_report_free(NULL, result->report);
    starg_certificate_free(result->certificate);
    starg_map_file_free(result->map);
    starg_morph_report_free(result->morph);
    starg_solid_map_free(NULL, result->solid_map);
    RELEASE(result);
}
