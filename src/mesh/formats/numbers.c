/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of a file in text or binary data. */
#include "mesh/formats/scan.h"

starg_place numbers_place(const number_scan *numbers) {
    if (numbers->encoding == NUMBERS_TEXT)
        return starg_at_line(numbers->scan.line);
    return starg_at_byte((size_t)(numbers->scan.at - numbers->scan.source->bytes));
}

size_t numbers_bytes(number_type type) {
    static const unsigned char bytes[] = {
        [NUMBER_INT8] = 1,    [NUMBER_UINT8] = 1, [NUMBER_INT16] = 2,
        [NUMBER_UINT16] = 2,  [NUMBER_INT32] = 4, [NUMBER_UINT32] = 4,
        [NUMBER_FLOAT32] = 4, [NUMBER_INT64] = 8, [NUMBER_FLOAT64] = 8};
    return bytes[type];
}

size_t numbers_least_bytes(const number_scan *numbers, number_type type) {
    return numbers->encoding == NUMBERS_TEXT ? 2 : numbers_bytes(type);
}

/* The next bytes as a 64-bit number, zero extended. */
static starg_status take_bits(number_scan *numbers, number_type type, const char *what,
                              uint64_t *bits) {
    size_t size = numbers_bytes(type);
    if ((size_t)(numbers->scan.end - numbers->scan.at) < size)
        return starg_source_fail(numbers->scan.source, numbers_place(numbers),
                                 "the file ends where %s is expected; it seems to be truncated",
                                 what);
    *bits = 0;
    for (size_t i = 0; i < size; i++) {
        size_t from = numbers->encoding == NUMBERS_LITTLE ? size - 1 - i : i;
        *bits = *bits << 8 | (unsigned char)numbers->scan.at[from];
    }
    numbers->scan.at += size;
    return STARG_OK;
}

static int64_t decode_integer(uint64_t bits, number_type type) {
    bool is_signed = type == NUMBER_INT8 || type == NUMBER_INT16 || type == NUMBER_INT32;
    uint64_t sign = is_signed ? UINT64_C(1) << (8 * numbers_bytes(type) - 1) : 0;
    return (int64_t)(bits ^ sign) - (int64_t)sign;
}

static double decode_real(uint64_t bits, number_type type) {
    double wide;
    float narrow;
    uint32_t half = (uint32_t)bits;
    if (type == NUMBER_FLOAT64) {
        memcpy(&wide, &bits, sizeof wide);
        return wide;
    }
    if (type != NUMBER_FLOAT32)
        return (double)decode_integer(bits, type);
    memcpy(&narrow, &half, sizeof narrow);
    return (double)narrow;
}

starg_status numbers_real(number_scan *numbers, number_type type, const char *what, double *value) {
    uint64_t bits = 0;
    if (numbers->encoding == NUMBERS_TEXT)
        return starg_scan_real(&numbers->scan, what, value);
    starg_status status = take_bits(numbers, type, what, &bits);
    if (status == STARG_OK)
        *value = decode_real(bits, type);
    return status;
}

starg_status numbers_integer(number_scan *numbers, number_type type, const char *what,
                             int64_t *value) {
    uint64_t bits = 0;
    if (numbers->encoding == NUMBERS_TEXT)
        return starg_scan_integer(&numbers->scan, what, value);
    TRY(take_bits(numbers, type, what, &bits));
    *value = decode_integer(bits, type);
    return STARG_OK;
}

starg_status numbers_check_count(const number_scan *numbers, int64_t count, size_t bytes,
                                 const char *what) {
    /* the last number of a text needs no blank after it */
    size_t left = (size_t)(numbers->scan.end - numbers->scan.at) + 1;
    if (count >= 0 && (uint64_t)count <= left / bytes)
        return STARG_OK;
    return starg_source_fail(numbers->scan.source, numbers_place(numbers),
                             "the file declares %lld %s, too many for the %zu bytes that follow; "
                             "the count is wrong or the file is truncated",
                             (long long)count, what, left - 1);
}
