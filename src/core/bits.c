/* SPDX-License-Identifier: Apache-2.0 */
#include "core/bits.h"

starg_status starg_bits_create(starg_context *context, size_t rows, size_t columns,
                               starg_bits **out) {
    starg_status status = STARG_OK;
    starg_bits *bits = NULL;
    *out = NULL;
    STARG_NEW_ZERO(context, "bits", bits, 1);
    *bits = (starg_bits){
        .context = context, .rows = rows, .columns = columns, .words = starg_bit_words(columns)};
    bits->data = starg_allocate_zero(context, rows, bits->words * sizeof *bits->data);
    if (bits->data == NULL) {
        status = starg_fail_memory(context, "bits");
        goto done;
    }
    *out = bits;
done:
    if (status != STARG_OK)
        starg_bits_free(bits);
    return status;
}

void starg_bits_free(starg_bits *bits) {
    if (bits == NULL)
        return;
    RELEASE(bits->data, bits);
}

size_t starg_bits_rows(const starg_bits *bits) {
    return bits->rows;
}

size_t starg_bits_columns(const starg_bits *bits) {
    return bits->columns;
}

size_t starg_bits_words(const starg_bits *bits) {
    return bits->words;
}

const uint64_t *starg_bits_row(const starg_bits *bits, size_t row) {
    return bits->data + row * bits->words;
}

bool starg_bits_test(const starg_bits *bits, size_t row, size_t column) {
    return starg_bit_test(starg_bits_row(bits, row), column);
}

void starg_bits_set(starg_bits *bits, size_t row, size_t column) {
    starg_bit_set(starg_bits_row_mutable(bits, row), column);
}

size_t starg_bits_count(const starg_bits *bits, size_t row) {
    return starg_bit_count(starg_bits_row(bits, row), bits->words);
}
