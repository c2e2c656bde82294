/* SPDX-License-Identifier: Apache-2.0 */
/* Recognizes the kind of a result file by its content. */
#include <jansson.h>

#include "core/file.h"
#include "core/memory.h"
#include "starguard/verify.h"

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
    starg_status status = STARG_OK;
    starg_result *result = NULL;
    char *bytes = NULL;
    size_t size;
    *out = NULL;
    STARG_NEW_ZERO(context, STAGE, result, 1);
    STARG_TRY(starg_file_read(context, STAGE, path, &bytes, &size));
    STARG_TRY(read_bytes(context, bytes, size, path, result));
    *out = result;
done:
    starg_release(context, bytes);
    if (status != STARG_OK)
        starg_result_free(context, result);
    return status;
}

void starg_result_free(starg_context *context, starg_result *result) {
    if (result == NULL)
        return;
    starg_guards_free(context, result->guards);
    starg_pieces_mesh_free(context, result->pieces);
    starg_pieces_report_free(context, result->report);
    starg_certificate_free(result->certificate);
    starg_map_file_free(result->map);
    starg_morph_report_free(result->morph);
    starg_solid_map_free(context, result->solid_map);
    starg_release(context, result);
}
