/* SPDX-License-Identifier: Apache-2.0 */
/* Internals of the public bit matrix, and word-wise helpers for bit rows. */
#pragma once

#include "core/memory.h"
#include "starguard/bits.h"

struct starg_bits {
    starg_context *context;
    size_t rows, columns, words;
    uint64_t *data;
};

static inline uint64_t *starg_bits_row_mutable(starg_bits *bits, size_t row) {
    return bits->data + row * bits->words;
}

static inline size_t starg_bit_words(size_t columns) {
    return (columns + 63) / 64;
}

static inline bool starg_bit_test(const uint64_t *row, size_t column) {
    return (row[column / 64] >> (column % 64)) & 1;
}

static inline void starg_bit_set(uint64_t *row, size_t column) {
    row[column / 64] |= (uint64_t)1 << (column % 64);
}

static inline void starg_bit_clear(uint64_t *row, size_t column) {
    row[column / 64] &= ~((uint64_t)1 << (column % 64));
}

static inline int starg_bit_lowest(uint64_t word) {
    return __builtin_ctzll(word);
}

/* The number of set bits, by sums of pairs, of fours and of bytes: without an instruction for it a
 * compiler calls a function that looks bytes up. */
static inline size_t starg_bits_in(uint64_t word) {
    word -= word >> 1 & 0x5555555555555555;
    word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
    word = (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F;
    return word * 0x0101010101010101 >> 56;
}

static inline size_t starg_bit_count(const uint64_t *row, size_t words) {
    size_t count = 0;
    for (size_t w = 0; w < words; w++)
        count += starg_bits_in(row[w]);
    return count;
}

/* Runs the body with BIT = index of each set bit of WORD (evaluated once). */
#define STARG_FOR_BITS(BIT, WORD)                                                                  \
    for (uint64_t starg_word_ = (WORD), BIT = 0;                                                   \
         starg_word_ != 0 && (BIT = (uint64_t)starg_bit_lowest(starg_word_), 1);                   \
         starg_word_ &= starg_word_ - 1)

STARG_DROP(starg_bits, starg_bits)
