/* JSON results as text: one line a key, reals with 17 significant digits, so that reading gives
 * back the same doubles. */
#ifndef STARG_CORE_JSON_H
#define STARG_CORE_JSON_H

#include <jansson.h>
#include <stdio.h>

#include "core/context.h"

/* Writes `before`, a value, which is consumed, and `after`; false when the value could not be made
 * (memory is out). */
bool starg_json_put(FILE *stream, const char *before, json_t *value, const char *after);

/* A copy of a path that can stand in JSON: where it is no UTF-8, bytes outside ASCII are replaced.
 * NULL stays NULL. Errors: MEMORY. */
starg_status starg_json_path(starg_context *context, const char *stage, const char *path,
                             char **copy);

#endif
