/* SPDX-License-Identifier: Apache-2.0 */
/* A lower bound on the number of guards, proven in integer arithmetic. */
#ifndef STARG_GUARD_BOUND_H
#define STARG_GUARD_BOUND_H

#include "guard/prices.h"

#define BOUND_ONE ((uint64_t)1 << 40)

/* How high prices may be, and how often each witness must be seen. */
enum { BOUND_HIGHEST = 4, BOUND_MOST_TIMES = 1000 };

/* Prices of witnesses and of odd sets, in units of 1 / BOUND_ONE. */
typedef struct whole_prices {
    uint64_t price[MOST_WITNESSES], odd[MOST_ODD_SETS];
    odd_sets sets;
} whole_prices;

/* Prices rounded down; those of BOUND_HIGHEST or more count as 0. `sets` may be NULL. */
void bound_round(const witness_prices *prices, const odd_sets *sets, whole_prices *whole);

/* What the row holds is worth. */
uint64_t bound_worth(const whole_prices *whole, const witness_row *row);
/* What all rows of a cover, that holds each witness `times` times, hold at least is worth. */
uint64_t bound_worth_of_all(const whole_prices *whole, size_t times);

/* A lower bound on the number of rows that cover every priced witness `times` times (at most
 * BOUND_MOST_TIMES): one row holds at most what is worth most, so k rows hold at most k times that.
 * 0 where no row holds anything. */
size_t bound_of_prices(const witness_row *const *rows, size_t count, const whole_prices *whole,
                       size_t times);

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

void branch_record_free(branch_record *record);

/* Do no `most` rows cover all the witnesses? */
typedef struct branch_question {
    const witness_row *const *rows;
    size_t count;
    const witness_row *wanted;
    size_t most;
    size_t nodes; /* that the proof may take */
} branch_question;

/* Proves it by branching on the rows that hold a witness, with prices of its own in each branch.
 * *proven is false if the nodes do not suffice. record: receives the proof if there is one; may be
 * NULL. Errors: MEMORY, CANCELLED. */
starg_status bound_by_branching(starg_context *context, const branch_question *question,
                                bool *proven, branch_record *record, uint64_t *work);

#endif
