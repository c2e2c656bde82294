/* SPDX-License-Identifier: Apache-2.0 */
/* Sketches: a few numbers of a signature that bound its distance to others from below. */
#ifndef STARG_SHAPE_SKETCH_H
#define STARG_SHAPE_SKETCH_H

#include <stddef.h>
#include <stdint.h>

#include "starguard/shape.h"

enum { SKETCH_MOST = 64 }; /* numbers, and an upper bound of their size at the end */

typedef struct sketch {
    size_t count;
    float numbers[SKETCH_MOST];
} sketch;

/* Numbers of a kind's sketches; 0 if the kind has none. */
size_t sketch_count(starg_signature_kind kind);

/* The numbers have passed the kind's check. */
void sketch_make(starg_signature_kind kind, const double *numbers, size_t count, sketch *out);

/* At most the distance of the signatures; both sketches are of the kind. */
double sketch_bound(starg_signature_kind kind, const sketch *a, const sketch *b);

/* Stored form: floats, the least significant byte first. */
enum { SKETCH_MOST_BYTES = 4 * SKETCH_MOST };
void sketch_store(const sketch *from, uint8_t bytes[SKETCH_MOST_BYTES]);
void sketch_load(const uint8_t *bytes, size_t count, sketch *out);

#endif
