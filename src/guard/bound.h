/* SPDX-License-Identifier: Apache-2.0 */
/* A lower bound on the number of guards, proven in integer arithmetic. */
#ifndef STARG_GUARD_BOUND_H
#define STARG_GUARD_BOUND_H

#include "core/memory.h"
#include "guard/witnesses.h"

#define BOUND_ONE ((uint64_t)1 << 40)

/* Prices as whole numbers of 1 / BOUND_ONE, rounded down; they must be below 16. */
void bound_round(const double price[MOST_WITNESSES], uint64_t whole[MOST_WITNESSES]);

/* A lower bound on the number of rows that cover every priced witness `times` times (at most
 * 1,000): one row covers at most the largest sum of prices over a row, so k rows cover at most k
 * times that. 0 where no row covers anything. */
size_t bound_of_prices(const witness_row *const *rows, size_t count,
                       const uint64_t price[MOST_WITNESSES], size_t times);

/* A node of a proof by branching: its own prices, or one branch for each row that holds some
 * witness. A node without any available row is not recorded. */
typedef struct branch_node {
    uint32_t witness;    /* UINT32_MAX: prices */
    size_t first, count; /* of the numbers: rows; or witness, price, witness, price, ... */
} branch_node;

/* The nodes of a proof in depth-first order. */
typedef struct branch_record {
    STARG_ARRAY(branch_node) nodes;
    STARG_ARRAY(uint64_t) numbers;
} branch_record;

void branch_record_free(starg_context *context, branch_record *record);

/* Proves, by branching on the rows that hold a witness, with prices of its own in each branch, that
 * no `most` rows cover all witnesses in `wanted`. *proven is false if `nodes` nodes do not suffice.
 * record: receives the proof if there is one; may be NULL. Errors: MEMORY, CANCELLED. */
starg_status bound_by_branching(starg_context *context, const witness_row *const *rows,
                                size_t count, const witness_row *wanted, size_t most, size_t nodes,
                                bool *proven, branch_record *record, uint64_t *work);

#endif
