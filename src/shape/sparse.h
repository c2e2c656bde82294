/* SPDX-License-Identifier: Apache-2.0 */
/* Sparse symmetric positive definite systems with many right-hand sides. */
#ifndef STARG_SHAPE_SPARSE_H
#define STARG_SHAPE_SPARSE_H

#include <stdint.h>

#include "core/context.h"

/* A matrix by columns, both triangles; duplicate entries are summed. */
typedef struct sparse_matrix {
    size_t size;
    int64_t *starts; /* of the columns, size + 1 */
    int64_t *rows;
    double *values;
} sparse_matrix;

typedef struct sparse_factors sparse_factors;

/* Factorizes a matrix. Errors, reported for `stage`: SOLVER (not positive definite), MEMORY. */
starg_status sparse_factorise(starg_context *context, const char *stage,
                              const sparse_matrix *matrix, sparse_factors **out);
void sparse_free(sparse_factors *f);

/* Solves for one right-hand side in place; `work` has `size` doubles. Any thread. */
void sparse_solve(const sparse_factors *f, double *values, double *work);

#endif
