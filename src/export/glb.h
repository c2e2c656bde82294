/* SPDX-License-Identifier: Apache-2.0 */
/* The container of binary glTF 2.0: a header, a chunk of JSON, a chunk of numbers. */
#pragma once

#include <jansson.h>
#include <stdio.h>

#include "core/context.h"

/* Component types of accessors and targets of views. */
enum {
    GLB_UNSIGNED_INT = 5125,
    GLB_FLOAT = 5126,
    GLB_ARRAY_BUFFER = 34962,
    GLB_ELEMENT_ARRAY_BUFFER = 34963
};

/* Single precision holds coordinates below this. */
#define GLB_LIMIT 1e38

/* Writes the numbers: the announced number of bytes, a multiple of four. */
typedef void glb_numbers(FILE *stream, const void *user);

/* Writes a file; path "-" is standard output. `json` is NULL if creating it ran out of memory.
 * Errors: MESH (over 4 GiB), WRITE, MEMORY. */
starg_status glb_write(starg_context *context, const char *stage, const char *path,
                       const json_t *json, size_t bytes, glb_numbers *put, const void *user);
