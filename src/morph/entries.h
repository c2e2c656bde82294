/* Sparse systems that are put together entry by entry. */
#ifndef STARG_MORPH_ENTRIES_H
#define STARG_MORPH_ENTRIES_H

#include "shape/sparse.h"

/* An entry of the matrix; entries of one place are summed, both triangles are given. */
typedef struct matrix_entry {
    uint32_t row, column;
    double value;
} matrix_entry;

/* Writes the quadratic form of w (x_a - x_b)^2, LINK_ENTRIES entries; the place behind them. */
enum { LINK_ENTRIES = 4 };
matrix_entry *entries_put_link(uint32_t a, uint32_t b, double w, matrix_entry *next);

/* Factorises a positive definite matrix of `size` rows. Errors: SOLVER, MEMORY. */
starg_status entries_factorise(starg_context *context, size_t size, const matrix_entry *entries,
                               size_t count, sparse_factors **out);

#endif
