/* SPDX-License-Identifier: Apache-2.0 */
/* Records in JSON: writes and reads structs by their field tables. */
#ifndef STARG_CORE_RECORD_H
#define STARG_CORE_RECORD_H

#include "core/fields.h"
#include "core/json.h"
#include "core/private.h"

/* Writes a struct as an object with a line for each key, `margin` blanks before it, and a line for
 * each item of a list that is marked so. False when memory is out. */
bool record_put(FILE *stream, const starg_fields *fields, const void *record, int margin)
    STARG_PRIVATE(record_put);

/* Fills a struct from the object that record_put writes. Members that the file lacks get their
 * defaults where the table allows it; lists are blocks of the context. What has been read stays in
 * `record` on failure, for its owner to free; a list's length is that of its blocks. `name` is the
 * file's, for messages. Errors: FORMAT (which key, and what it must be), MEMORY. */
starg_status record_read(starg_context *context, const char *name, json_t *object,
                         const starg_fields *fields, void *record) STARG_PRIVATE(record_read);

/* The failure of a reader that finds something wrong beyond what the tables know. */
starg_status record_reject(starg_context *context, const char *name, const starg_fields *fields,
                           const char *key, const char *expected) STARG_PRIVATE(record_reject);

#endif
