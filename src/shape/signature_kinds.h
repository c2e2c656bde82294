/* SPDX-License-Identifier: Apache-2.0 */
/* Kinds of signatures: their contents and their comparison. A new kind is an entry in the table of
 * signature.c and a file of its own. */
#pragma once

#include "core/context.h"
#include "starguard/descriptor.h"

/* Computes the numbers in a new block. A failure keeps the model out of a database. */
typedef starg_status signature_compute(starg_context *context, const starg_mesh *mesh,
                                       double **numbers, size_t *count);
typedef starg_status signature_derive(starg_context *context, const starg_descriptor *descriptor,
                                      double **numbers, size_t *count);

/* Are these valid numbers of the kind? They may come from a damaged file. */
typedef bool signature_check(const double *numbers, size_t count);

/* Symmetric, not negative, 0 for equal numbers; both have passed the check. Errors: MEMORY. */
typedef starg_status signature_compare(starg_context *context, const double *a, size_t a_count,
                                       const double *b, size_t b_count, double *out);

/* Multiplies the numbers by their weights: the distance is the L1 or L2 norm of the difference. */
typedef void signature_weigh(const double *numbers, double *out);
enum { SIGNATURE_MOST_WEIGHTED = 512 };

/* Either `compute` or `derive` makes the numbers, and either `compare` or `weigh` gives the
 * distance; the other one is NULL. Kinds that weigh have sketches, of sums over runs of
 * `run` numbers; whoever changes weights or runs raises the version. */
typedef struct signature_method {
    const char *name;
    int version;
    signature_compute *compute;
    signature_derive *derive;
    signature_check *check;
    signature_compare *compare;
    signature_weigh *weigh;
    size_t count, run; /* if it weighs: numbers in all, and in a run */
    bool euclidean;    /* L2 instead of L1 */
} signature_method;

/* Of a valid kind. */
const signature_method *signature_method_of(starg_signature_kind kind);

extern const signature_method signature_d2;
extern const signature_method signature_shape_dna;
extern const signature_method signature_star;
extern const signature_method signature_paper;

/* ---- sketches: a few numbers that bound the distance of signatures from below (sketch.c) ---- */

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
