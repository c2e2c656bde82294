/* SPDX-License-Identifier: Apache-2.0 */
/* Fingerprint of a surface: FNV-1a (64 bits) over the positions of all corners. It does not depend
 * on where a face starts or on whether coincident vertices are merged. It detects a wrong model
 * early; equal sums prove nothing. */
#pragma once

#include <stdint.h>
#include <string.h>

#define STARG_CHECKSUM_BEGIN UINT64_C(0xcbf29ce484222325)

static inline uint64_t starg_checksum_double(uint64_t sum, double x) {
    uint64_t bits;
    x += 0.0; /* -0 becomes 0 */
    memcpy(&bits, &x, sizeof bits);
    for (int k = 0; k < 8; k++)
        sum = (sum ^ (bits >> 8 * k & 0xff)) * UINT64_C(0x100000001b3);
    return sum;
}

static inline int starg_checksum_compare(const double *a, const double *b) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

/* Adds a face, its corners sorted by coordinates. */
static inline uint64_t starg_checksum_face(uint64_t sum, const double *points,
                                           const uint32_t *corners) {
    const double *corner[3];
    for (size_t i = 0; i < 3; i++) {
        const double *p = points + 3 * (size_t)corners[i];
        size_t at = i;
        for (; at > 0 && starg_checksum_compare(p, corner[at - 1]) < 0; at--)
            corner[at] = corner[at - 1];
        corner[at] = p;
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            sum = starg_checksum_double(sum, corner[i][k]);
    return sum;
}
