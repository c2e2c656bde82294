/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of a file in text or binary data. */
#pragma once

#include "mesh/formats/scan.h"

typedef enum number_encoding { NUMBERS_TEXT, NUMBERS_LITTLE, NUMBERS_BIG } number_encoding;
typedef enum number_type {
    NUMBER_INT32,
    NUMBER_INT64,
    NUMBER_FLOAT32,
    NUMBER_FLOAT64,
    NUMBER_INT8,
    NUMBER_INT16,
    NUMBER_UINT8,
    NUMBER_UINT16,
    NUMBER_UINT32
} number_type;

typedef struct number_scan {
    starg_scan scan; /* binary data uses only its `at`, text lines in between all of it */
    number_encoding encoding;
} number_scan;

starg_place numbers_place(const number_scan *numbers);

/* The next number, of this type in binary data. `what` as in scan.h. Errors: FORMAT. */
starg_status numbers_real(number_scan *numbers, number_type type, const char *what, double *value);
starg_status numbers_integer(number_scan *numbers, number_type type, const char *what,
                             int64_t *value);

/* Size of a number in binary data. */
size_t numbers_bytes(number_type type);

/* Smallest size of a number: in text one digit and a blank. */
size_t numbers_least_bytes(const number_scan *numbers, number_type type);

/* Fails unless 0 <= count and `count` items of `bytes` each fit into the rest of the file. */
starg_status numbers_check_count(const number_scan *numbers, int64_t count, size_t bytes,
                                 const char *what);
