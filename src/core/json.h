/* SPDX-License-Identifier: Apache-2.0 */
/* JSON results as text: one key a line, reals with 17 significant digits, so that reading gives
 * back the same doubles. */
#pragma once

#include "core/context.h"
#include "core/fields.h"

#include <jansson.h>
#include <stdio.h>

/* ---- texts and files (json.c) ---- */

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

/* ---- records: structs by their field tables (record.c) ---- */

/* Writes a struct as an object, one key a line, indented by `margin` blanks; lists that are marked
 * so get one item a line. False when out of memory. */
bool record_put(FILE *stream, const starg_fields *fields, const void *record, int margin)
    STARG_PRIVATE(record_put);

/* Fills a struct from an object that record_put wrote. Missing members get their defaults where the
 * table allows it; lists are blocks of the context. On failure `record` keeps what was read, for
 * its owner to free; list lengths match their blocks. `name` is the file's name, for messages.
 * Errors: FORMAT (which key, and what it must be), MEMORY. */
starg_status record_read(starg_context *context, const char *name, json_t *object,
                         const starg_fields *fields, void *record) STARG_PRIVATE(record_read);

/* FORMAT error of a reader, for conditions that the tables do not express. */
starg_status record_reject(starg_context *context, const char *name, const starg_fields *fields,
                           const char *key, const char *expected) STARG_PRIVATE(record_reject);
