/* SPDX-License-Identifier: Apache-2.0 */
/* Prices of witnesses, and the bounds that they prove. */
#pragma once

#include "core/memory.h"
#include "guard/cells.h"
#include "starguard/guard.h"

#include <string.h>

/* ---- odd sets of witnesses, which prove more than their witnesses one by one (odd_sets.c) ---- */
/* If rows together hold every witness of a set T, the numbers that they hold of it sum to at least
 * |T|; so the sum of half of each of these numbers, rounded up, is at least half of |T|, rounded up
 * [zero-half cuts: Caprara, Fischetti 1996; of art galleries in the plane: Fekete, Friedrichs,
 * Kroeller, Schmidt 2015]. Three witnesses, any two of which some point sees but no point all
 * three, need two points, where prices of single witnesses prove one and a half. */

enum { MOST_ODD_SETS = 192, ODD_SET_SIZE = 7 };

typedef struct odd_set {
    uint16_t witness[ODD_SET_SIZE]; /* ascending */
    uint16_t count;                 /* odd, 3 or more */
} odd_set;

typedef struct odd_sets {
    size_t count;
    odd_set set[MOST_ODD_SETS];
    uint16_t first[MOST_WITNESSES + 1]; /* by witness: where its sets begin in `of`, and the end */
    uint16_t of[MOST_ODD_SETS * ODD_SET_SIZE];
} odd_sets;

/* By set, half of what the row holds of it, rounded up. */
static inline void odd_sets_halves(const odd_sets *sets, const witness_row *row,
                                   uint8_t halves[MOST_ODD_SETS]) {
    memset(halves, 0, sets->count);
    for (size_t w = 0; w < WITNESS_WORDS && sets->count > 0; w++)
        STARG_FOR_BITS (bit, row->bits[w])
            for (size_t k = sets->first[64 * w + bit]; k < sets->first[64 * w + bit + 1]; k++)
                halves[sets->of[k]]++;
    for (size_t k = 0; k < sets->count; k++)
        halves[k] = (uint8_t)((halves[k] + 1) / 2);
}

/* A fractional cover of the witnesses, and the prices that it was found with. */
typedef struct odd_sets_question {
    const witness_row *const *rows;
    const double *share; /* by row */
    size_t count;
    const double *price; /* by witness */
} odd_sets_question;

/* Leaves out the sets without a price, and adds some that the fractional cover holds too little of;
 * `price`, by set, goes along. *added: how many. Errors: MEMORY. */
starg_status odd_sets_renew(starg_context *context, const odd_sets_question *question,
                            odd_sets *sets, double price[MOST_ODD_SETS], size_t *added,
                            uint64_t *work);

/* ---- the fractional cover of witnesses by rows, and its dual prices (prices.c) ---- */

typedef struct witness_prices {
    double price[MOST_WITNESSES]; /* no row's sum exceeds 1; 0 if not requested */
    double odd[MOST_ODD_SETS];    /* of half of an odd set: of each half that a row holds */
    double sum;                   /* of the prices: a lower bound on every cover */
    double *share;                /* by row: its value in a fractional cover */
    uint64_t work;                /* in units of about a microsecond */
} witness_prices;

/* Prices of the witnesses in `wanted` and of the odd sets (NULL: none) with maximal sum (up to a
 * thousandth); some row holds each of these witnesses, and each one of the sets. Errors: MEMORY. */
starg_status prices_find(starg_context *context, const witness_row *const *rows, size_t count,
                         const witness_row *wanted, const odd_sets *sets, witness_prices *out);

/* What the row holds is worth. */
static inline double prices_of_row(const witness_prices *prices, const odd_sets *sets,
                                   const witness_row *row) {
    uint8_t halves[MOST_ODD_SETS];
    double sum = row_value(row, prices->price);
    odd_sets_halves(sets, row, halves);
    for (size_t k = 0; k < sets->count; k++)
        sum += halves[k] * prices->odd[k];
    return sum;
}
void prices_free(witness_prices *prices);

/* ---- a lower bound on the number of guards, proven in integer arithmetic (bound.c) ---- */

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

/* ---- the proof of a bound, as a text that verify checks (certificate.c) ---- */
/* The format is in docs/formats.md. */

/* What proves the bound: prices, or rows that need a cover of this size, by branching. */
typedef struct bound_proof {
    size_t bound;
    whole_prices prices;           /* without rows */
    STARG_ARRAY(witness_row) rows; /* each leaf is within one of them */
    branch_record branches;
} bound_proof;

typedef struct guard_certificate {
    bound_proof proof;
    char *text; /* NULL until written */
    size_t size;
} guard_certificate;

void certificate_free(guard_certificate *why);

/* Records the prices that proved `bound`, if it improves on the previous one. `why` may be NULL. */
void certificate_note_prices(guard_certificate *why, size_t bound, const whole_prices *prices);
/* The same for rows; takes `branches` over. Errors: MEMORY. */
starg_status certificate_note_rows(starg_context *context, guard_certificate *why, size_t bound,
                                   const witness_row *const *rows, size_t count,
                                   branch_record *branches);

/* Writes the text from the record and the tree of cells, whose reasons are recomputed. Errors:
 * MEMORY, CANCELLED. */
starg_status certificate_of_search(const search_scene *scene, const search_cells *cells,
                                   const starg_guard_options *options, guard_certificate *why);

/* The text for a bound of 1, where `witness` must be seen, or of 0 where nothing must (UINT32_MAX).
 * Errors: MEMORY. */
starg_status certificate_of_one(starg_context *context, const starg_solid *solid,
                                const starg_guard_options *options, uint32_t witness,
                                guard_certificate *why);
