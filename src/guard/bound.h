/* SPDX-License-Identifier: Apache-2.0 */
/* How many guards are needed, proven in whole numbers. */
#ifndef STARG_GUARD_BOUND_H
#define STARG_GUARD_BOUND_H

#include "core/memory.h"
#include "guard/witnesses.h"

#define BOUND_ONE ((uint64_t)1 << 40)

/* Prices as whole numbers of 1 / BOUND_ONE, rounded down; they must be below 16. */
void bound_round(const double price[MOST_WITNESSES], uint64_t whole[MOST_WITNESSES]);

/* No fewer rows than that hold all witnesses that have a price, each so many `times` (1,000 at
 * most): one row holds at most the largest sum of prices over a row, so that k of them hold at most
 * k times that. 0 where no row holds anything. */
size_t bound_of_prices(const witness_row *const *rows, size_t count,
                       const uint64_t price[MOST_WITNESSES], size_t times);

/* A node of a proof by branching: prices of its own, or one branch for each of some rows that hold
 * a witness. A node without any row to take has no node of the record. */
typedef struct branch_node {
    uint32_t witness;    /* UINT32_MAX: prices                                           */
    size_t first, count; /* of the numbers: rows; or witness, price, witness, price, ... */
} branch_node;

/* The nodes of a proof, each followed by those of its branches. */
typedef struct branch_record {
    STARG_ARRAY(branch_node) nodes;
    STARG_ARRAY(uint64_t) numbers;
} branch_record;

void branch_record_free(starg_context *context, branch_record *record);

/* Is it certain that `most` of the rows do not hold all witnesses in `wanted`? By branching on the
 * row that holds a witness, each branch with prices of its own; *proven is false where that does
 * not follow after `nodes` of them. record: what has proven it, if it is; or NULL. Errors: MEMORY,
 * CANCELLED. */
starg_status bound_by_branching(starg_context *context, const witness_row *const *rows,
                                size_t count, const witness_row *wanted, size_t most, size_t nodes,
                                bool *proven, branch_record *record, uint64_t *work);

#endif
