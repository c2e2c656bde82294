/* SPDX-License-Identifier: Apache-2.0 */
#include "core/json.h"

#include <stdlib.h>

#include "core/file.h"
#include "core/memory.h"

enum { DUMP = JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17) };

/* jansson either reports an allocation failure or fails silently; it never fails silently on
 * malformed text. */
static bool is_out_of_memory(const json_error_t *error) {
    return json_error_code(error) == json_error_out_of_memory || error->text[0] == '\0';
}

starg_status starg_json_parse(starg_context *context, const char *stage, const char *name,
                              const void *bytes, size_t size, json_t **root) {
    json_error_t error;
    *root = json_loadb(size > 0 ? bytes : "", size, JSON_REJECT_DUPLICATES, &error);
    if (*root != NULL)
        return STARG_OK;
    if (is_out_of_memory(&error))
        return starg_fail_memory(context, stage);
    uint64_t line = error.line > 0 ? (uint64_t)error.line : 1;
    return starg_fail_at(context, STARG_ERROR_FORMAT, stage, STARG_ELEMENT_LINE, &line, 1,
                         "'%.200s', line %llu: %s", name, (unsigned long long)line, error.text);
}

bool starg_json_put(FILE *stream, const char *before, json_t *value, const char *after) {
    if (value == NULL)
        return false;
    fputs(before, stream);
    bool written = json_dumpf(value, stream, DUMP) == 0;
    fputs(after, stream);
    json_decref(value);
    return written || ferror(stream);
}

starg_status starg_json_path(starg_context *context, const char *stage, const char *path,
                             char **copy) {
    *copy = NULL;
    if (path == NULL)
        return STARG_OK;
    size_t length = strlen(path);
    NEW(context, stage, *copy, length + 1);
    memcpy(*copy, path, length + 1);
    json_t *probe = json_string(path);
    if (probe == NULL)
        for (size_t i = 0; i < length; i++)
            if ((unsigned char)path[i] >= 0x80)
                (*copy)[i] = '?';
    json_decref(probe);
    return STARG_OK;
}

starg_status starg_json_write(starg_context *context, const char *stage, const char *path,
                              starg_json_writer *put, const void *result, const char *model_file) {
    starg_output output = {0};
    SCOPED char *shown = NULL;
    TRY(starg_json_path(context, stage, model_file, &shown));
    TRY(starg_output_open(context, stage, path, &output));
    if (!put(output.stream, result, shown)) {
        starg_output_discard(&output);
        return starg_fail_memory(context, stage);
    }
    return starg_output_commit(&output);
}

starg_status starg_json_write_memory(starg_context *context, const char *stage,
                                     starg_json_writer *put, const void *result,
                                     const char *model_file, char **text, size_t *size) {
    starg_status status = STARG_OK;
    char *shown = NULL, *bytes = NULL;
    FILE *stream = NULL;
    *text = NULL;
    *size = 0;
    STARG_TRY(starg_json_path(context, stage, model_file, &shown));
    stream = open_memstream(&bytes, size);
    bool whole = stream != NULL && put(stream, result, shown) && !ferror(stream);
    if (stream == NULL || fclose(stream) != 0 || !whole) {
        status = starg_fail_memory(context, stage);
        goto done;
    }
    STARG_NEW(context, stage, *text, *size + 1);
    memcpy(*text, bytes, *size + 1);
done:
    free(bytes);
    starg_release(context, shown);
    return status;
}
