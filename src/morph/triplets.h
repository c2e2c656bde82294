/* SPDX-License-Identifier: Apache-2.0 */
/* Sparse systems assembled from triplets. */
#pragma once

#include "shape/spectrum.h"

/* A matrix entry; duplicates are summed, both triangles are given. */
typedef struct triplet {
    uint32_t row, column;
    double value;
} triplet;

/* Writes the quadratic form of w (x_a - x_b)^2 as EDGE_TRIPLETS triplets; returns the place after
 * them. */
enum { EDGE_TRIPLETS = 4 };
triplet *triplets_put_edge(uint32_t a, uint32_t b, double w, triplet *next);

/* Factorizes a positive definite matrix with `size` rows. Errors: SOLVER, MEMORY. */
starg_status triplets_factorise(starg_context *context, size_t size, const triplet *triplets,
                                size_t count, sparse_factors **out);
