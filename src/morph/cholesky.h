/* Sparse symmetric systems that are solved for many right-hand sides. */
#ifndef STARG_MORPH_CHOLESKY_H
#define STARG_MORPH_CHOLESKY_H

#include <stdint.h>

#include "core/context.h"

typedef struct cholesky cholesky;

/* An entry of the matrix; entries of one place are summed, both triangles are given. */
typedef struct matrix_entry {
    uint32_t row, column;
    double value;
} matrix_entry;

/* Writes the quadratic form of w (x_a - x_b)^2, LINK_ENTRIES entries; the place behind them. */
enum { LINK_ENTRIES = 4 };
matrix_entry *matrix_put_link(uint32_t a, uint32_t b, double w, matrix_entry *next);

/* Factorises a positive definite matrix of `size` rows. Errors: SOLVER, MEMORY. */
starg_status cholesky_create(starg_context *context, size_t size, const matrix_entry *entries,
                             size_t count, cholesky **out);
void cholesky_free(cholesky *c);

/* Solves for one right-hand side in place; `work` holds `size` doubles. Any thread. */
void cholesky_solve(const cholesky *c, double *values, double *work);

#endif
