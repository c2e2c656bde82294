/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers as little-endian bytes. */
#pragma once

#include <stdint.h>
#include <string.h>

static inline void pack_u32(unsigned char *bytes, uint32_t value) {
    for (int i = 0; i < 4; i++)
        bytes[i] = (unsigned char)(value >> 8 * i);
}

static inline void pack_f32(unsigned char *bytes, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    pack_u32(bytes, bits);
}

static inline void pack_f64(unsigned char *bytes, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    pack_u32(bytes, (uint32_t)bits);
    pack_u32(bytes + 4, (uint32_t)(bits >> 32));
}
