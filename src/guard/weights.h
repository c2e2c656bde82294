/* SPDX-License-Identifier: Apache-2.0 */
/* What the columns of a pool weigh: a coverage below 1 is meant by area, so each face weighs its
 * share of the total area in units of 2^-40, at least one, that the cover works on integers;
 * vertices weigh one unit each. Where faces matter more or less (starg_space_weigh), their areas
 * are meant to be so many times as large; what is no target weighs nothing. */
#ifndef STARG_GUARD_WEIGHTS_H
#define STARG_GUARD_WEIGHTS_H

#include "mesh/solid.h"
#include "starguard/visibility.h"

typedef struct column_weights {
    double *areas; /* by face, in units of their own */
    double area;   /* of all faces */
    uint64_t *weights;
    uint64_t total;
    size_t faces; /* that are targets */
} column_weights;

/* Errors: MEMORY. */
starg_status column_weights_create(starg_context *context, const starg_solid *solid,
                                   starg_target target, column_weights *out);
void column_weights_free(starg_context *context, column_weights *weights);

#endif
