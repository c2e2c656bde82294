/* SPDX-License-Identifier: Apache-2.0 */
/* Binary glTF 2.0: a 12-byte header, then two chunks, each with its length and its type; the JSON
 * is padded with blanks to a multiple of four bytes. */
#include "export/export.h"

#include "core/file.h"
#include "core/memory.h"

enum { HEADER = 12, CHUNK_HEADER = 8 };

static void put_head(FILE *stream, const char *text, size_t length, size_t bytes) {
    size_t padded = (length + 3) / 4 * 4;
    fwrite("glTF", 1, 4, stream);
    little_put_word(stream, 2);
    little_put_word(stream, (uint32_t)(HEADER + 2 * CHUNK_HEADER + padded + bytes));
    little_put_word(stream, (uint32_t)padded);
    fwrite("JSON", 1, 4, stream);
    fwrite(text, 1, length, stream);
    for (size_t i = length; i < padded; i++)
        fputc(' ', stream);
    little_put_word(stream, (uint32_t)bytes);
    fwrite("BIN", 1, 4, stream);
}

starg_status glb_write(starg_context *context, const char *stage, const char *path,
                       const json_t *json, size_t bytes, glb_numbers *put, const void *user) {
    starg_output output;
    SCOPED char *text = NULL;
    size_t length = json != NULL ? json_dumpb(json, NULL, 0, JSON_COMPACT) : 0;
    if (length == 0)
        return starg_fail_memory(context, stage);
    if (bytes > UINT32_MAX - 2 * HEADER - 2 * CHUNK_HEADER - length)
        return starg_fail(context, STARG_ERROR_MESH, stage,
                          "%zu bytes of numbers exceed the limit of this format", bytes);
    NEW(context, stage, text, length);
    json_dumpb(json, text, length, JSON_COMPACT);
    TRY(starg_output_open(context, stage, path, &output));
    put_head(output.stream, text, length, bytes);
    put(output.stream, user);
    return starg_output_commit(&output);
}
