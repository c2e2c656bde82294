/* SPDX-License-Identifier: Apache-2.0 */
/* Records in JSON: writes and reads structs by their field tables. */
#pragma once

#include "core/fields.h"
#include "core/json.h"

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
