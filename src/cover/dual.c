/* SPDX-License-Identifier: Apache-2.0 */
/* Lower bound on the size of full covers: the Lagrangian dual, in integers.
 *
 * For any multipliers u >= 0, one per column,
 *     L(u) = sum_j demand(j) u(j) + sum_i min(0, 1 - sum of u over the columns of row i)
 * is at most the size of every cover: a cover pays at least demand(j) u(j) for each column j.
 * Multipliers are stored as integer multiples of 2^-20, so L is evaluated exactly however u was
 * found, and L rounded up to a whole number of rows is a proven bound. */
#include "cover/cover.h"

#include <stdlib.h>

/* Rows are scanned in strips of a cache line, restricted to columns with a nonzero multiplier:
 * after some steps most are zero. */
enum { STRIP = 8 };

/* Bits of a strip's columns with nonzero multipliers. */
static void mark_strip(const cover_instance *instance, const int64_t *multipliers, size_t first,
                       size_t count, uint64_t *marks) {
    for (size_t k = 0; k < count; k++) {
        size_t column = 64 * (first + k);
        marks[k] = 0;
        for (size_t bit = 0; bit < 64 && column + bit < instance->columns; bit++)
            marks[k] |= (uint64_t)(multipliers[column + bit] != 0) << bit;
    }
}

static int64_t strip_sum(const uint64_t *words, const uint64_t *marks, size_t count,
                         const int64_t *multipliers) {
    int64_t sum = 0;
    for (size_t k = 0; k < count; k++) {
        STARG_FOR_BITS (bit, words[k] & marks[k])
            sum += multipliers[64 * k + bit];
    }
    return sum;
}

int64_t cover_dual_value(const cover_instance *instance, const int64_t *multipliers,
                         int64_t *reduced) {
    int64_t value = 0;
    uint64_t marks[STRIP];
    for (size_t j = 0; j < instance->columns; j++)
        value += multipliers[j] * instance->demands[j];
    for (size_t i = 0; i < instance->rows; i++)
        reduced[i] = COVER_ONE;
    for (size_t first = 0; first < instance->row_words; first += STRIP) {
        size_t left = instance->row_words - first, count = left < STRIP ? left : STRIP;
        mark_strip(instance, multipliers, first, count, marks);
        for (size_t i = 0; i < instance->rows; i++)
            reduced[i] -=
                strip_sum(cover_row(instance, i) + first, marks, count, multipliers + 64 * first);
    }
    for (size_t i = 0; i < instance->rows; i++)
        value += reduced[i] < 0 ? reduced[i] : 0;
    return value;
}

/* Raises the multiplier of one column until the smallest reduced cost among its rows is zero. */
static int64_t raise_column(const cover_instance *instance, size_t column, int64_t *left) {
    int64_t least = COVER_ONE;
    const uint64_t *rows = cover_column(instance, column);
    for (size_t w = 0; w < instance->column_words; w++) {
        STARG_FOR_BITS (bit, rows[w]) {
            if (left[64 * w + bit] < least)
                least = left[64 * w + bit];
        }
    }
    if (least == 0)
        return 0;
    for (size_t w = 0; w < instance->column_words; w++) {
        STARG_FOR_BITS (bit, rows[w])
            left[64 * w + bit] -= least;
    }
    return least;
}

typedef struct rare_column {
    size_t supply, column;
} rare_column;

static int compare_rare(const void *a, const void *b) {
    const rare_column *x = a, *y = b;
    if (x->supply != y->supply)
        return x->supply < y->supply ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

/* Dual ascent: raises multipliers one by one, rare columns first, while all reduced costs stay at
 * least 0. Fast and weak. */
static starg_status ascend(const cover_instance *instance, int64_t *multipliers) {
    starg_context *context = instance->context;
    SCOPED int64_t *left = NULL;
    SCOPED rare_column *order = NULL;
    NEW(context, "bound", left, instance->rows);
    NEW(context, "bound", order, instance->columns);
    for (size_t i = 0; i < instance->rows; i++)
        left[i] = COVER_ONE;
    for (size_t j = 0; j < instance->columns; j++)
        order[j] =
            (rare_column){starg_bit_count(cover_column(instance, j), instance->column_words), j};
    qsort(order, instance->columns, sizeof *order, compare_rare);
    for (size_t k = 0; k < instance->columns; k++)
        multipliers[order[k].column] = raise_column(instance, order[k].column, left);
    return STARG_OK;
}

starg_status cover_dual_create(const cover_instance *instance, cover_dual *out) {
    starg_context *context = instance->context;
    *out = (cover_dual){0};
    NEW(context, "bound", out->multipliers, instance->columns);
    NEW(context, "bound", out->reduced, instance->rows);
    TRY(ascend(instance, out->multipliers));
    out->value = cover_dual_value(instance, out->multipliers, out->reduced);
    return STARG_OK;
}

void cover_dual_free(cover_dual *dual) {
    RELEASE(dual->multipliers, dual->reduced);
    *dual = (cover_dual){0};
}

void cover_dual_offer(const cover_instance *instance, cover_dual *dual, const int64_t *multipliers,
                      const int64_t *reduced, int64_t value) {
    if (value <= dual->value)
        return;
    dual->value = value;
    memcpy(dual->multipliers, multipliers, instance->columns * sizeof *multipliers);
    memcpy(dual->reduced, reduced, instance->rows * sizeof *reduced);
}

bool cover_dual_fix(const cover_instance *instance, const cover_dual *dual, size_t most,
                    uint64_t *keep, uint64_t *take) {
    /* Forcing row i in (or out) raises the bound by its positive (negative) reduced cost. */
    int64_t slack = (int64_t)most * COVER_ONE - dual->value;
    bool any = false;
    for (size_t i = 0; i < instance->rows; i++) {
        if (dual->reduced[i] > slack)
            starg_bit_clear(keep, i);
        else if (-dual->reduced[i] > slack)
            starg_bit_set(take, i);
        else
            continue;
        any = true;
    }
    return any;
}
