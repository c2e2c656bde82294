/* SPDX-License-Identifier: Apache-2.0 */
/* Working form of a cover problem: only relevant columns, identical ones merged, with the bits by
 * rows and by columns.
 *
 * Columns of weight 0 and columns in no row never count and are removed. Columns in the same rows
 * with the same demand are covered together, so one column carries the sum of their weights. Both
 * hold in every mode. Given rows lower the demands of their columns and are then left without
 * columns. Cost: O(rows x columns / 64 + columns log columns). */
#pragma once

#include "core/bits.h"
#include "starguard/cover.h"

/* Sums of products of weights and counts. */
__extension__ typedef __int128 cover_wide;

typedef struct cover_instance {
    starg_context *context;
    size_t rows, columns;
    size_t row_words;    /* words per row: one bit per column */
    size_t column_words; /* words per column: one bit per row */
    size_t used_words;   /* words per row of row_used: one bit per word of the row */
    uint64_t *row_bits, *column_bits;
    uint64_t *row_used;     /* the words of a row that may hold bits: of large scenes, few */
    uint64_t *weights;      /* per column, positive; their sum is below 2^62 */
    uint32_t *demands;      /* per column, 1 to the number of its rows (before rows are dropped) */
    uint32_t *row_names;    /* per row: its index in the caller's matrix */
    uint32_t *column_names; /* per column: the first column it represents */
    uint64_t total;         /* sum of the weights */
} cover_instance;

/* Shared by the stages of one call. */
typedef struct cover_run {
    starg_context *context;
    size_t max_nodes;
    size_t nodes;      /* branch-and-bound nodes used so far */
    bool time_limited; /* the time limit cut some stage short */
    bool relaxed;      /* nothing beyond the linear relaxation */
    bool local;        /* full covers: nothing but a short local search */
    double *prices;    /* per column of the caller's matrix, or NULL */
} cover_run;

/* A list of row names. */
typedef STARG_ARRAY(uint32_t) cover_names;

static inline const uint64_t *cover_row(const cover_instance *instance, size_t row) {
    return instance->row_bits + row * instance->row_words;
}

/* Runs the body with W = index of each word of a row that may hold bits. */
#define COVER_FOR_WORDS(W, INSTANCE, ROW)                                                          \
    for (size_t used_ = 0; used_ < (INSTANCE)->used_words; used_++)                                \
        for (uint64_t words_ = (INSTANCE)->row_used[(ROW) * (INSTANCE)->used_words + used_],       \
                      W = 0;                                                                       \
             words_ != 0 && (W = 64 * used_ + (uint64_t)starg_bit_lowest(words_), 1);              \
             words_ &= words_ - 1)

static inline const uint64_t *cover_column(const cover_instance *instance, size_t column) {
    return instance->column_bits + column * instance->column_words;
}

/* True after the time limit; records that it cut something short. */
static inline bool cover_time_is_over(cover_run *run) {
    if (starg_time_is_over(run->context))
        run->time_limited = true;
    return run->time_limited;
}

/* Builds the working form of a checked problem; *given receives the weight covered by the given
 * rows, which is not part of the instance. Errors: MEMORY. */
starg_status cover_instance_build(starg_context *context, const starg_cover_problem *problem,
                                  cover_instance *out, uint64_t *given);

/* Extracts the rows and columns set in the masks (NULL: all). Weights, demands and names stay the
 * same. Errors: MEMORY. */
starg_status cover_instance_select(const cover_instance *from, const uint64_t *rows,
                                   const uint64_t *columns, cover_instance *out);

/* Leaves the rows set in the mask, in place. Errors: MEMORY, which leaves all. */
starg_status cover_instance_keep_rows(cover_instance *instance, const uint64_t *rows);

/* Frees the arrays and empties the instance; a zeroed one is allowed. */
void cover_instance_free(cover_instance *instance);

/* Sets the first `count` bits of a mask and clears the rest of its last word. */
void cover_mask_fill(uint64_t *mask, size_t count);
