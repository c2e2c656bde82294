/* SPDX-License-Identifier: Apache-2.0 */
/* What all certificates are written with (docs/formats.md). */
#ifndef STARG_GUARD_CERTIFICATE_TEXT_H
#define STARG_GUARD_CERTIFICATE_TEXT_H

#include <stdio.h>

#include "geometry/bvh.h"
#include "mesh/solid.h"

/* A double as an integer and a power of two, after a character. */
void certificate_put_double(FILE *stream, char before, double x);

/* The first lines: the version, and what identifies the model. */
void certificate_put_model(FILE *stream, int version, const starg_solid *solid);

/* The line of the box that everything is in. */
void certificate_put_root(FILE *stream, const bvh_box *root);

/* *text (`size` bytes and a zero) becomes what `put` writes. Errors: MEMORY. */
typedef void certificate_put(FILE *stream, const void *what);
starg_status certificate_write(starg_context *context, certificate_put *put, const void *what,
                               char **text, size_t *size);

#endif
