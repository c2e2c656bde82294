/* SPDX-License-Identifier: Apache-2.0 */
/* What fuzz targets share: demands that end the process, bytes read as choices, small meshes made
 * of them, files for readers that take a path. */
#ifndef TESTS_FUZZ_SUPPORT_H
#define TESTS_FUZZ_SUPPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shapes.h"
#include "starguard/context.h"
#include "starguard/mesh.h"

/* What every target defines; it returns 0. */
int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

/* Says what is violated, and aborts. */
void fuzz_require(bool condition, const char *what);

/* The same for a call that may not fail. */
void fuzz_require_ok(const starg_context *context, starg_status status, const char *what);

/* A call of a reader: it must have failed with FORMAT, RANGE or MESH and a message in printable
 * characters. */
void fuzz_require_explained(const starg_context *context, starg_status status);

/* One thread, seed 1. */
starg_context *fuzz_context(void);

/* All memory must have been returned. */
void fuzz_context_end(starg_context *context);

/* ---- choices ---- */

/* Input that is read from its beginning; behind its end there are zeros. */
typedef struct fuzz_input {
    const unsigned char *at;
    size_t left;
} fuzz_input;

uint32_t fuzz_byte(fuzz_input *in);

/* 0 to bound - 1, of one byte, or of two for bounds above 256. */
uint32_t fuzz_below(fuzz_input *in, uint32_t bound);

/* Eight bytes as a double; 0 where that is not finite, or not below 1e100. */
double fuzz_double(fuzz_input *in);

/* A coordinate: mostly small integers and halves, else anything. */
double fuzz_coordinate(fuzz_input *in);

/* ---- meshes ---- */

enum { FUZZ_FACES = 64, FUZZ_VERTICES = 128 };

/* A surface of at most so many faces and vertices, most often closed: unit cells, blobs, prisms
 * over polygons, or faces between any vertices; then edited (vertices moved, faces turned, dropped,
 * doubled and rewired), and placed at some scale. To be freed with shape_free. */
shape fuzz_shape(fuzz_input *in);

starg_mesh *fuzz_mesh(starg_context *context, const shape *s);

/* ---- files ---- */

/* A path of this process's own with the given extension, in a folder that is removed in the end;
 * valid until the next call with the same extension. At most eight extensions. */
const char *fuzz_path(const char *extension);

/* The same, of a file that holds these bytes. */
const char *fuzz_file(const char *extension, const void *bytes, size_t size);

#endif
