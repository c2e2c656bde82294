/* SPDX-License-Identifier: Apache-2.0 */
/* Working form of a cover problem: only relevant columns, identical ones merged, with the bits by
 * rows and by columns.
 *
 * Columns of weight 0 and columns in no row never count and are removed. Columns in the same rows
 * with the same demand are covered together, so one column carries the sum of their weights. Both
 * hold in every mode. Given rows lower the demands of their columns and are then left without
 * columns. Cost: O(rows x columns / 64 + columns log columns). */
#include "cover/cover.h"

#include <stdlib.h>

/* Transposes a 64 x 64 block of bits: swaps halves, then quarters, ... */
static void transpose_block(uint64_t block[64]) {
    uint64_t mask = UINT64_C(0x00000000ffffffff);
    for (unsigned step = 32; step != 0; step >>= 1, mask ^= mask << step) {
        for (unsigned k = 0; k < 64; k = ((k | step) + 1) & ~step) {
            uint64_t swap = ((block[k] >> step) ^ block[k | step]) & mask;
            block[k | step] ^= swap;
            block[k] ^= swap << step;
        }
    }
}

/* `to` has one row of to_words words for each of the `columns` columns of `from`. */
static void transpose(const uint64_t *from, size_t rows, size_t columns, size_t from_words,
                      uint64_t *to, size_t to_words) {
    for (size_t w = 0; w < from_words; w++) {
        size_t width = columns - 64 * w < 64 ? columns - 64 * w : 64;
        for (size_t v = 0; v < to_words; v++) {
            size_t height = rows - 64 * v < 64 ? rows - 64 * v : 64;
            uint64_t block[64] = {0};
            for (size_t i = 0; i < height; i++)
                block[i] = from[(64 * v + i) * from_words + w];
            transpose_block(block);
            for (size_t j = 0; j < width; j++)
                to[(64 * w + j) * to_words + v] = block[j];
        }
    }
}

void cover_mask_fill(uint64_t *mask, size_t count) {
    size_t words = starg_bit_words(count);
    for (size_t w = 0; w < words; w++)
        mask[w] = UINT64_MAX;
    if (count % 64 != 0)
        mask[words - 1] = ((uint64_t)1 << (count % 64)) - 1;
}

void cover_instance_free(cover_instance *instance) {
    RELEASE(instance->row_bits, instance->row_used, instance->column_bits, instance->weights,
            instance->demands, instance->row_names, instance->column_names);
    *instance = (cover_instance){.context = instance->context};
}

/* Sets the sizes and allocates; the contents are undefined. */
static starg_status shape(starg_context *context, size_t rows, size_t columns,
                          cover_instance *out) {
    *out = (cover_instance){.context = context,
                            .rows = rows,
                            .columns = columns,
                            .row_words = starg_bit_words(columns),
                            .used_words = starg_bit_words(starg_bit_words(columns)),
                            .column_words = starg_bit_words(rows)};
    NEW(context, "cover", out->weights, columns);
    NEW(context, "cover", out->demands, columns);
    NEW(context, "cover", out->row_names, rows);
    NEW(context, "cover", out->column_names, columns);
    out->row_bits = starg_allocate(context, rows, out->row_words * sizeof *out->row_bits);
    out->row_used = starg_allocate_zero(context, rows, out->used_words * sizeof *out->row_used);
    out->column_bits =
        starg_allocate(context, columns, out->column_words * sizeof *out->column_bits);
    return out->row_bits != NULL && out->row_used != NULL && out->column_bits != NULL
               ? STARG_OK
               : starg_fail_memory(context, "cover");
}

/* Indices of the set bits of a mask of `count` bits (NULL: all). */
static starg_status list_kept(starg_context *context, const uint64_t *mask, size_t count,
                              uint32_t **list, size_t *kept) {
    *kept = 0;
    NEW(context, "cover", *list, count);
    for (size_t i = 0; i < count; i++) {
        if (mask == NULL || starg_bit_test(mask, i))
            (*list)[(*kept)++] = (uint32_t)i;
    }
    return STARG_OK;
}

static void copy_words(uint64_t *to, const uint64_t *from, size_t count) {
    if (count != 0)
        memcpy(to, from, count * sizeof *to);
}

/* Notes which words of the rows hold bits. */
static void mark_used(cover_instance *instance) {
    for (size_t i = 0; i < instance->rows; i++)
        for (size_t w = 0; w < instance->row_words; w++)
            if (cover_row(instance, i)[w] != 0)
                starg_bit_set(instance->row_used + i * instance->used_words, w);
}

/* The kept columns, of all rows. */
static starg_status select_columns(const cover_instance *from, const uint64_t *columns,
                                   cover_instance *out) {
    SCOPED uint32_t *kept = NULL;
    size_t count, words = from->column_words;
    TRY(list_kept(from->context, columns, from->columns, &kept, &count));
    TRY(shape(from->context, from->rows, count, out));
    for (size_t j = 0; j < count; j++) {
        copy_words(out->column_bits + j * words, cover_column(from, kept[j]), words);
        out->weights[j] = from->weights[kept[j]];
        out->demands[j] = from->demands[kept[j]];
        out->column_names[j] = from->column_names[kept[j]];
        out->total += out->weights[j];
    }
    transpose(out->column_bits, count, from->rows, words, out->row_bits, out->row_words);
    memcpy(out->row_names, from->row_names, from->rows * sizeof *out->row_names);
    return STARG_OK;
}

starg_status cover_instance_keep_rows(cover_instance *instance, const uint64_t *rows) {
    SCOPED uint32_t *kept = NULL;
    size_t count, words = instance->row_words, used = instance->used_words;
    TRY(list_kept(instance->context, rows, instance->rows, &kept, &count));
    for (size_t i = 0; i < count; i++) {
        if (words != 0) {
            memmove(instance->row_bits + i * words, instance->row_bits + kept[i] * words,
                    words * sizeof *instance->row_bits);
            memmove(instance->row_used + i * used, instance->row_used + kept[i] * used,
                    used * sizeof *instance->row_used);
        }
        instance->row_names[i] = instance->row_names[kept[i]];
    }
    instance->rows = count;
    instance->column_words = starg_bit_words(count);
    transpose(instance->row_bits, count, instance->columns, words, instance->column_bits,
              instance->column_words);
    return STARG_OK;
}

starg_status cover_instance_select(const cover_instance *from, const uint64_t *rows,
                                   const uint64_t *columns, cover_instance *out) {
    *out = (cover_instance){.context = from->context};
    TRY(select_columns(from, columns, out));
    if (rows != NULL)
        TRY(cover_instance_keep_rows(out, rows));
    mark_used(out);
    return STARG_OK;
}

/* The number of columns up to the last one that some row holds. In scenes the faces of the model,
 * which are to be seen, come first, and what follows is as much again. */
static size_t count_held(const starg_bits *bits) {
    size_t words = bits->words;
    for (bool any = false; words > 0 && !any;) {
        for (size_t i = 0; i < bits->rows && !any; i++)
            any = starg_bits_row(bits, i)[words - 1] != 0;
        words -= !any;
    }
    return 64 * words < bits->columns ? 64 * words : bits->columns;
}

/* The caller's matrix as an instance, without columns behind the last one in use. */
static starg_status import(starg_context *context, const starg_cover_problem *problem,
                           cover_instance *out) {
    const starg_bits *bits = problem->rows;
    TRY(shape(context, bits->rows, count_held(bits), out));
    for (size_t i = 0; i < bits->rows; i++)
        copy_words(out->row_bits + i * out->row_words, starg_bits_row(bits, i), out->row_words);
    transpose(out->row_bits, out->rows, out->columns, out->row_words, out->column_bits,
              out->column_words);
    for (size_t i = 0; i < out->rows; i++)
        out->row_names[i] = (uint32_t)i;
    for (size_t j = 0; j < out->columns; j++) {
        size_t supply = starg_bit_count(cover_column(out, j), out->column_words);
        out->column_names[j] = (uint32_t)j;
        out->weights[j] = problem->weights ? problem->weights[j] : 1;
        size_t need = problem->needs != NULL ? problem->needs[j] : problem->redundancy;
        out->demands[j] = (uint32_t)(supply < need ? supply : need);
    }
    return STARG_OK;
}

static void empty_row(cover_instance *instance, size_t row) {
    uint64_t *bits = instance->row_bits + row * instance->row_words;
    for (size_t w = 0; w < instance->row_words; w++) {
        STARG_FOR_BITS (bit, bits[w])
            starg_bit_clear(instance->column_bits + (64 * w + bit) * instance->column_words, row);
        bits[w] = 0;
    }
}

/* Applies the given rows; *covered sums the weights of the columns they satisfy. */
static void take_given(const starg_cover_problem *problem, cover_instance *instance,
                       uint64_t *covered) {
    *covered = 0;
    for (size_t k = 0; k < problem->given_count; k++) {
        const uint64_t *bits = cover_row(instance, problem->given[k]);
        for (size_t w = 0; w < instance->row_words; w++) {
            STARG_FOR_BITS (bit, bits[w]) {
                size_t column = 64 * w + bit;
                if (instance->demands[column] > 0 && --instance->demands[column] == 0)
                    *covered += instance->weights[column];
            }
        }
        empty_row(instance, problem->given[k]);
    }
}

typedef struct hashed_column {
    uint64_t hash;
    uint32_t column;
} hashed_column;

static int compare_hashed(const void *a, const void *b) {
    const hashed_column *x = a, *y = b;
    if (x->hash != y->hash)
        return x->hash < y->hash ? -1 : 1;
    return (x->column > y->column) - (x->column < y->column);
}

static uint64_t hash_words(const uint64_t *words, size_t count) {
    uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
    for (size_t w = 0; w < count; w++) {
        hash = (hash ^ words[w]) * UINT64_C(0xff51afd7ed558ccd);
        hash ^= hash >> 32;
    }
    return hash;
}

static bool same_column(const cover_instance *instance, size_t a, size_t b) {
    return instance->demands[a] == instance->demands[b] &&
           memcmp(cover_column(instance, a), cover_column(instance, b),
                  instance->column_words * sizeof(uint64_t)) == 0;
}

/* In a run of equal hashes, adds the weight of each column to the first equal column. */
static void merge_run(cover_instance *instance, const hashed_column *run, size_t count,
                      uint64_t *keep) {
    for (size_t a = 0; a < count; a++) {
        uint32_t first = run[a].column;
        if (!starg_bit_test(keep, first))
            continue;
        for (size_t b = a + 1; b < count; b++) {
            uint32_t other = run[b].column;
            if (!starg_bit_test(keep, other) || !same_column(instance, first, other))
                continue;
            instance->weights[first] += instance->weights[other];
            starg_bit_clear(keep, other);
        }
    }
}

/* Marks one column of each set of identical ones, and sums their weights. */
static starg_status merge_columns(cover_instance *instance, uint64_t *keep) {
    starg_context *context = instance->context;
    SCOPED hashed_column *order = NULL;
    size_t count = 0;
    NEW(context, "cover", order, instance->columns);
    for (size_t j = 0; j < instance->columns; j++) {
        if (instance->demands[j] == 0 || instance->weights[j] == 0)
            continue;
        uint64_t hash = hash_words(cover_column(instance, j), instance->column_words);
        order[count++] = (hashed_column){hash, (uint32_t)j};
        starg_bit_set(keep, j);
    }
    qsort(order, count, sizeof *order, compare_hashed);
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && order[end].hash == order[begin].hash;)
            end++;
        merge_run(instance, order + begin, end - begin, keep);
    }
    return STARG_OK;
}

starg_status cover_instance_build(starg_context *context, const starg_cover_problem *problem,
                                  cover_instance *out, uint64_t *given) {
    SCOPED_BY(cover_instance_free) cover_instance all = {.context = context};
    SCOPED uint64_t *keep = NULL;
    *out = (cover_instance){.context = context};
    TRY(import(context, problem, &all));
    take_given(problem, &all, given);
    NEW_ZERO(context, "cover", keep, all.row_words);
    TRY(merge_columns(&all, keep));
    starg_release(context, all.row_bits); /* what follows takes the columns */
    all.row_bits = NULL;
    return cover_instance_select(&all, NULL, keep, out);
}
