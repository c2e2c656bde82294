/* SPDX-License-Identifier: Apache-2.0 */
/* JSON results as text: one line a key, reals with 17 significant digits, so that reading gives
 * back the same doubles. */
#ifndef STARG_CORE_JSON_H
#define STARG_CORE_JSON_H

#include <jansson.h>
#include <stdio.h>

#include "core/context.h"
#include "core/private.h"

/* Parses a text, `name` in messages; *root is given back with json_decref. Names that stand twice
 * in an object are an error. Errors: FORMAT (with the line), MEMORY. */
starg_status starg_json_parse(starg_context *context, const char *stage, const char *name,
                              const void *bytes, size_t size, json_t **root)
    STARG_PRIVATE(starg_json_parse);

/* Writes `before`, a value, which is consumed, and `after`; false when the value could not be made
 * (memory is out). */
bool starg_json_put(FILE *stream, const char *before, json_t *value, const char *after)
    STARG_PRIVATE(starg_json_put);

/* A copy of a path that can stand in JSON: where it is no UTF-8, bytes outside ASCII are replaced.
 * NULL stays NULL. Errors: MEMORY. */
starg_status starg_json_path(starg_context *context, const char *stage, const char *path,
                             char **copy);

/* Writes a result to `path` ("-" is standard output), whole or not at all. `put` writes all of it
 * and is false when memory is out; `model_file` is the model's path for it, or NULL. Errors: WRITE,
 * MEMORY. */
typedef bool starg_json_writer(FILE *stream, const void *result, const char *model_file);
starg_status starg_json_write(starg_context *context, const char *stage, const char *path,
                              starg_json_writer *put, const void *result, const char *model_file)
    STARG_PRIVATE(starg_json_write);

/* The same into a block of the context, with one zero byte behind the end. Errors: MEMORY. */
starg_status starg_json_write_memory(starg_context *context, const char *stage,
                                     starg_json_writer *put, const void *result,
                                     const char *model_file, char **text, size_t *size)
    STARG_PRIVATE(starg_json_write_memory);

#endif
