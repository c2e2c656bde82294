/* SPDX-License-Identifier: Apache-2.0 */
/* JSON results as text: one key a line, reals with 17 significant digits, so that reading gives
 * back the same doubles. */
#pragma once

#include <jansson.h>
#include <stdio.h>

#include "core/context.h"

/* Parses a text; messages call it `name`. Free *root with json_decref. Duplicate keys are an error.
 * Errors: FORMAT (with the line), MEMORY. */
starg_status starg_json_parse(starg_context *context, const char *stage, const char *name,
                              const void *bytes, size_t size, json_t **root)
    STARG_PRIVATE(starg_json_parse);

/* Writes `before`, the value (consumed) and `after`; false when out of memory (`value` is
 * then NULL). */
bool starg_json_put(FILE *stream, const char *before, json_t *value, const char *after)
    STARG_PRIVATE(starg_json_put);

/* Copies a path for use in JSON: if it is not UTF-8, bytes outside ASCII are replaced. NULL stays
 * NULL. Errors: MEMORY. */
starg_status starg_json_path(starg_context *context, const char *stage, const char *path,
                             char **copy);

/* Writes a result to `path` ("-": standard output), completely or not at all. `put` writes
 * everything and returns false when out of memory; it receives `model_file`, the model's path or
 * NULL. Errors: WRITE, MEMORY. */
typedef bool starg_json_writer(FILE *stream, const void *result, const char *model_file);
starg_status starg_json_write(starg_context *context, const char *stage, const char *path,
                              starg_json_writer *put, const void *result, const char *model_file)
    STARG_PRIVATE(starg_json_write);

/* Same into a block of the context, followed by one zero byte. Errors: MEMORY. */
starg_status starg_json_write_memory(starg_context *context, const char *stage,
                                     starg_json_writer *put, const void *result,
                                     const char *model_file, char **text, size_t *size)
    STARG_PRIVATE(starg_json_write_memory);
