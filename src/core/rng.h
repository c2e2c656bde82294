/* SPDX-License-Identifier: Apache-2.0 */
/* Random numbers that depend only on (seed, stage, item), never on the order of calls or threads:
 * the splitmix64 finaliser over a counter. */
#pragma once

#include <math.h>
#include <stdint.h>

#include "core/compiler.h"

typedef struct starg_rng {
    uint64_t state;
} starg_rng;

static inline uint64_t starg_hash64(uint64_t x) {
    x ^= x >> 30;
    x *= UINT64_C(0xbf58476d1ce4e5b9);
    x ^= x >> 27;
    x *= UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

static inline starg_rng starg_rng_make(uint64_t seed, uint64_t stage, uint64_t item) {
    return (starg_rng){starg_hash64(starg_hash64(starg_hash64(seed) + stage) + item)};
}

static inline uint64_t starg_rng_next(starg_rng *rng) {
    rng->state += UINT64_C(0x9e3779b97f4a7c15);
    return starg_hash64(rng->state);
}

/* Uniform in [0, 1) with 53 bits. */
static inline double starg_rng_unit(starg_rng *rng) {
    return (double)(starg_rng_next(rng) >> 11) * 0x1p-53;
}

/* Uniform in [0, bound); bound > 0. The bias is below bound / 2^64. */
static inline uint64_t starg_rng_below(starg_rng *rng, uint64_t bound) {
    return (uint64_t)(((starg_uint128)starg_rng_next(rng) * bound) >> 64);
}

/* Uniform on the unit sphere. */
static inline void starg_rng_direction(starg_rng *rng, double out[3]) {
    double z = 2 * starg_rng_unit(rng) - 1, angle = 6.283185307179586 * starg_rng_unit(rng);
    double side = sqrt(1 - z * z);
    out[0] = side * cos(angle);
    out[1] = side * sin(angle);
    out[2] = z;
}
