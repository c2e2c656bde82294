/* SPDX-License-Identifier: Apache-2.0 */
/* Weights of a pool's columns: a coverage below 1 refers to area, so each face weighs its share of
 * the total area in units of 2^-40, at least one, because the cover works on integers; vertices
 * weigh one unit each. Importance weights of faces (starg_space_weigh) multiply their areas; what
 * is not a target weighs nothing. */
#ifndef STARG_GUARD_WEIGHTS_H
#define STARG_GUARD_WEIGHTS_H

#include "mesh/solid.h"
#include "starguard/visibility.h"

typedef struct column_weights {
    double *areas; /* by face, in arbitrary units */
    double area;   /* of all faces */
    uint64_t *weights;
    uint64_t total;
    uint64_t kept; /* of the columns that guards that stay see often enough; not in the total */
    size_t faces;  /* number of target faces */
} column_weights;

/* Errors: MEMORY. */
starg_status column_weights_create(starg_context *context, const starg_solid *solid,
                                   starg_target target, column_weights *out);
void column_weights_free(column_weights *weights);

/* The weight of the columns in a row of so many words. */
static inline uint64_t column_weights_of(const column_weights *weights, const uint64_t *row,
                                         size_t words) {
    uint64_t sum = 0;
    for (size_t w = 0; w < words; w++)
        STARG_FOR_BITS (bit, row[w])
            sum += weights->weights[64 * w + bit];
    return sum;
}

#endif
