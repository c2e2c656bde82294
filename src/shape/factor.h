/* Systems of equations with a Laplacian. */
#ifndef STARG_SHAPE_FACTOR_H
#define STARG_SHAPE_FACTOR_H

#include "shape/laplacian.h"

typedef struct factor {
    int64_t count;
    int64_t *order, *inverse; /* of the rows */
    int64_t *parents, *sizes, *flags, *pattern;
    int64_t *starts, *rows;
    double *values, *diagonal, *row;
} factor;

/* Factorises L + shift M; shift > 0. Errors: SOLVER, MEMORY. */
starg_status factor_create(starg_context *context, const laplacian *l, double shift, factor *out);
void factor_free(starg_context *context, factor *f);

/* Replaces x by the solution y of (L + shift M) y = x; `scratch` has room for as many numbers. */
void factor_solve(const factor *f, double *x, double *scratch);

/* Why there is none. */
starg_status factor_fail(starg_context *context);

#endif
