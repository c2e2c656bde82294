/* SPDX-License-Identifier: Apache-2.0 */
/* The working form of a cover problem: only columns that count, identical ones merged, with the
 * bits by rows and by columns.
 *
 * Columns of weight 0 and columns that no row holds never count, so they are left out. Columns
 * that the same rows hold, with the same demand, are covered together or not at all, so one column
 * with the sum of their weights stands for all of them.
 * Both hold in every mode. Given rows lower the demands of what they hold and are then left without
 * columns. Cost: O(rows x columns / 64 + columns log columns). */
#ifndef STARG_COVER_INSTANCE_H
#define STARG_COVER_INSTANCE_H

#include "core/bits.h"
#include "core/memory.h"
#include "starguard/cover.h"

/* Sums of products of weights and counts. */
__extension__ typedef __int128 cover_wide;

typedef struct cover_instance {
    starg_context *context;
    size_t rows, columns;
    size_t row_words;    /* words of one row: one bit per column */
    size_t column_words; /* words of one column: one bit per row */
    uint64_t *row_bits, *column_bits;
    uint64_t *weights;      /* per column, positive; their sum is below 2^62  */
    uint32_t *demands;      /* per column, 1 to the number of rows that hold it,
                               unless rows have been dropped since            */
    uint32_t *row_names;    /* per row: its index in the caller's matrix      */
    uint32_t *column_names; /* per column: the first of those it stands for */
    uint64_t total;         /* sum of the weights                             */
} cover_instance;

/* What the stages of one call share. */
typedef struct cover_run {
    starg_context *context;
    size_t max_nodes;
    size_t nodes;      /* branch-and-bound nodes used so far          */
    bool time_limited; /* some stage was cut short by the time limit  */
    bool relaxed;      /* everything: no more than the linear relaxation */
    double *prices;    /* per column of the caller's matrix, or NULL  */
} cover_run;

/* A list of row names. */
typedef STARG_ARRAY(uint32_t) cover_names;

static inline const uint64_t *cover_row(const cover_instance *instance, size_t row) {
    return instance->row_bits + row * instance->row_words;
}

static inline const uint64_t *cover_column(const cover_instance *instance, size_t column) {
    return instance->column_bits + column * instance->column_words;
}

/* True when the time limit has passed; remembers that it cut something short. */
static inline bool cover_time_is_over(cover_run *run) {
    if (starg_time_is_over(run->context))
        run->time_limited = true;
    return run->time_limited;
}

/* Builds the working form of a checked problem; *given gets the weight that the given rows cover,
 * which is not part of the instance. Errors: MEMORY. */
starg_status cover_instance_build(starg_context *context, const starg_cover_problem *problem,
                                  cover_instance *out, uint64_t *given);

/* Builds the part of `from` whose rows and columns are set in the masks (NULL: all of them).
 * Weights, demands and names are carried over unchanged. Errors: MEMORY. */
starg_status cover_instance_select(const cover_instance *from, const uint64_t *rows,
                                   const uint64_t *columns, cover_instance *out);

/* Frees the arrays and empties the instance; harmless on a zeroed one. */
void cover_instance_free(cover_instance *instance);

/* Sets the first `count` bits of a mask and clears the rest of its last word. */
void cover_mask_fill(uint64_t *mask, size_t count);

#endif
