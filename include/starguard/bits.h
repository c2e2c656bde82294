/* SPDX-License-Identifier: Apache-2.0 */
/* A bit matrix in rows of 64-bit words: what each point sees, and the input of set cover. Bit j of
 * row i is bit j % 64 of word j / 64; bits after the last column are zero. */
#ifndef STARGUARD_BITS_H
#define STARGUARD_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct starg_bits starg_bits;

/* Creates a zero matrix. Errors: MEMORY. */
STARG_API starg_status starg_bits_create(starg_context *context, size_t rows, size_t columns,
                                         starg_bits **out);
STARG_API void starg_bits_free(starg_bits *bits);

STARG_API size_t starg_bits_rows(const starg_bits *bits);
STARG_API size_t starg_bits_columns(const starg_bits *bits);
/* 64-bit words from one row to the next. */
STARG_API size_t starg_bits_words(const starg_bits *bits);
STARG_API const uint64_t *starg_bits_row(const starg_bits *bits, size_t row);
STARG_API bool starg_bits_test(const starg_bits *bits, size_t row, size_t column);
/* Sets one bit; only while the creator fills the matrix. */
STARG_API void starg_bits_set(starg_bits *bits, size_t row, size_t column);
/* Number of ones in a row. */
STARG_API size_t starg_bits_count(const starg_bits *bits, size_t row);

#ifdef __cplusplus
}
#endif

#endif
