/* SPDX-License-Identifier: Apache-2.0 */
/* Little-endian numbers in binary files, on any machine. */
#pragma once

#include <stdint.h>
#include <stdio.h>
#include <string.h>

static inline void little_put_word(FILE *stream, uint32_t x) {
    uint8_t bytes[4];
    for (int k = 0; k < 4; k++)
        bytes[k] = (uint8_t)(x >> (8 * k));
    fwrite(bytes, 1, sizeof bytes, stream);
}

static inline void little_put_long(FILE *stream, uint64_t x) {
    little_put_word(stream, (uint32_t)x);
    little_put_word(stream, (uint32_t)(x >> 32));
}

static inline void little_put_float(FILE *stream, float x) {
    uint32_t word;
    memcpy(&word, &x, sizeof word);
    little_put_word(stream, word);
}

static inline void little_put_double(FILE *stream, double x) {
    uint64_t word;
    memcpy(&word, &x, sizeof word);
    little_put_long(stream, word);
}
