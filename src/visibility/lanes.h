/* SPDX-License-Identifier: Apache-2.0 */
/* Eight doubles or WIDE floats at a time, in the ISA variant selected by the including file with
 * LANES_PLAIN, LANES_NEON, LANES_AVX2 or LANES_AVX512. Bit k of a mask stands for lane k;
 * comparisons with NaN are false. */
#ifndef STARG_VISIBILITY_LANES_H
#define STARG_VISIBILITY_LANES_H

#include <stdint.h>
#include <string.h>

enum { WIDE = 16 };

#if defined(LANES_AVX512)

#include <immintrin.h>

typedef __m512d lanes;

static inline lanes lanes_load(const double *p) {
    return _mm512_loadu_pd(p);
}

static inline lanes lanes_dot(const double w[3], lanes x, lanes y, lanes z) {
    lanes sum = _mm512_mul_pd(_mm512_set1_pd(w[0]), x);
    sum = _mm512_fmadd_pd(_mm512_set1_pd(w[1]), y, sum);
    return _mm512_fmadd_pd(_mm512_set1_pd(w[2]), z, sum);
}

/* a + b + c - d */
static inline lanes lanes_beyond(lanes a, lanes b, lanes c, double d) {
    return _mm512_sub_pd(_mm512_add_pd(_mm512_add_pd(a, b), c), _mm512_set1_pd(d));
}

static inline lanes lanes_min(lanes a, lanes b) {
    return _mm512_min_pd(a, b);
}

static inline uint64_t lanes_above(lanes a, double limit) {
    return _mm512_cmp_pd_mask(a, _mm512_set1_pd(limit), _CMP_GT_OQ);
}

/* |a| > limit */
static inline uint64_t lanes_beyond_either(lanes a, double limit) {
    return lanes_above(_mm512_abs_pd(a), limit);
}

static inline lanes lanes_add(lanes a, lanes b) {
    return _mm512_add_pd(a, b);
}

/* Writes 1 above the limit, -1 below its negative, otherwise 0. */
static inline void lanes_store_signs(lanes a, double limit, int8_t *out) {
    __mmask8 above = _mm512_cmp_pd_mask(a, _mm512_set1_pd(limit), _CMP_GT_OQ);
    __mmask8 below = _mm512_cmp_pd_mask(a, _mm512_set1_pd(-limit), _CMP_LT_OQ);
    __m512i signs = _mm512_mask_set1_epi64(_mm512_maskz_set1_epi64(above, 1), below, -1);
    _mm_storel_epi64((__m128i *)(void *)out, _mm512_cvtepi64_epi8(signs));
}

typedef __m512 wide;

static inline wide wide_load(const float *p) {
    return _mm512_loadu_ps(p);
}

static inline wide wide_set(float a) {
    return _mm512_set1_ps(a);
}

static inline wide wide_add(wide a, wide b) {
    return _mm512_add_ps(a, b);
}

static inline wide wide_subtract(wide a, wide b) {
    return _mm512_sub_ps(a, b);
}

static inline wide wide_multiply(wide a, wide b) {
    return _mm512_mul_ps(a, b);
}

static inline wide wide_abs(wide a) {
    return _mm512_abs_ps(a);
}

static inline wide wide_min(wide a, wide b) {
    return _mm512_min_ps(a, b);
}

static inline wide wide_max(wide a, wide b) {
    return _mm512_max_ps(a, b);
}

static inline uint32_t wide_above(wide a, wide b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ);
}

static inline uint32_t wide_equal(const uint32_t *p, uint32_t value) {
    return _mm512_cmpeq_epi32_mask(_mm512_loadu_si512(p), _mm512_set1_epi32((int)value));
}

/* Which of the numbers have the bit? */
static inline uint32_t wide_marked(const uint32_t *p, uint32_t bit) {
    return _mm512_test_epi32_mask(_mm512_loadu_si512(p), _mm512_set1_epi32((int)bit));
}

#elif defined(LANES_AVX2)

#include <immintrin.h>

typedef struct lanes {
    __m256d low, high;
} lanes;

static inline lanes lanes_load(const double *p) {
    return (lanes){_mm256_loadu_pd(p), _mm256_loadu_pd(p + 4)};
}

static inline lanes lanes_dot(const double w[3], lanes x, lanes y, lanes z) {
    __m256d a = _mm256_set1_pd(w[0]), b = _mm256_set1_pd(w[1]), c = _mm256_set1_pd(w[2]);
    __m256d low = _mm256_fmadd_pd(b, y.low, _mm256_mul_pd(a, x.low));
    __m256d high = _mm256_fmadd_pd(b, y.high, _mm256_mul_pd(a, x.high));
    return (lanes){_mm256_fmadd_pd(c, z.low, low), _mm256_fmadd_pd(c, z.high, high)};
}

static inline lanes lanes_beyond(lanes a, lanes b, lanes c, double d) {
    __m256d all = _mm256_set1_pd(d);
    return (lanes){_mm256_sub_pd(_mm256_add_pd(_mm256_add_pd(a.low, b.low), c.low), all),
                   _mm256_sub_pd(_mm256_add_pd(_mm256_add_pd(a.high, b.high), c.high), all)};
}

static inline lanes lanes_min(lanes a, lanes b) {
    return (lanes){_mm256_min_pd(a.low, b.low), _mm256_min_pd(a.high, b.high)};
}

static inline uint64_t lanes_above(lanes a, double limit) {
    __m256d all = _mm256_set1_pd(limit);
    unsigned low = (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a.low, all, _CMP_GT_OQ));
    unsigned high = (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a.high, all, _CMP_GT_OQ));
    return low | high << 4;
}

static inline uint64_t lanes_beyond_either(lanes a, double limit) {
    __m256d sign = _mm256_set1_pd(-0.0);
    return lanes_above((lanes){_mm256_andnot_pd(sign, a.low), _mm256_andnot_pd(sign, a.high)},
                       limit);
}

static inline lanes lanes_add(lanes a, lanes b) {
    return (lanes){_mm256_add_pd(a.low, b.low), _mm256_add_pd(a.high, b.high)};
}

static inline void lanes_store_signs(lanes a, double limit, int8_t *out) {
    const uint64_t ones = UINT64_C(0x0101010101010101);
    __m256d sign = _mm256_set1_pd(-0.0);
    lanes opposite = {_mm256_xor_pd(sign, a.low), _mm256_xor_pd(sign, a.high)};
    uint64_t above = _pdep_u64(lanes_above(a, limit), ones);
    uint64_t below = _pdep_u64(lanes_above(opposite, limit), ones);
    above += 255 * below;
    memcpy(out, &above, sizeof above);
}

typedef struct wide {
    __m256 low, high;
} wide;

static inline wide wide_load(const float *p) {
    return (wide){_mm256_loadu_ps(p), _mm256_loadu_ps(p + 8)};
}

static inline wide wide_set(float a) {
    return (wide){_mm256_set1_ps(a), _mm256_set1_ps(a)};
}

static inline wide wide_add(wide a, wide b) {
    return (wide){_mm256_add_ps(a.low, b.low), _mm256_add_ps(a.high, b.high)};
}

static inline wide wide_subtract(wide a, wide b) {
    return (wide){_mm256_sub_ps(a.low, b.low), _mm256_sub_ps(a.high, b.high)};
}

static inline wide wide_multiply(wide a, wide b) {
    return (wide){_mm256_mul_ps(a.low, b.low), _mm256_mul_ps(a.high, b.high)};
}

static inline wide wide_abs(wide a) {
    __m256 sign = _mm256_set1_ps(-0.0f);
    return (wide){_mm256_andnot_ps(sign, a.low), _mm256_andnot_ps(sign, a.high)};
}

static inline wide wide_min(wide a, wide b) {
    return (wide){_mm256_min_ps(a.low, b.low), _mm256_min_ps(a.high, b.high)};
}

static inline wide wide_max(wide a, wide b) {
    return (wide){_mm256_max_ps(a.low, b.low), _mm256_max_ps(a.high, b.high)};
}

static inline uint32_t wide_above(wide a, wide b) {
    unsigned low = (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a.low, b.low, _CMP_GT_OQ));
    unsigned high = (unsigned)_mm256_movemask_ps(_mm256_cmp_ps(a.high, b.high, _CMP_GT_OQ));
    return low | high << 8;
}

static inline uint32_t wide_equal(const uint32_t *p, uint32_t value) {
    __m256i all = _mm256_set1_epi32((int)value);
    __m256i low = _mm256_cmpeq_epi32(_mm256_loadu_si256((const __m256i *)(const void *)p), all);
    __m256i high =
        _mm256_cmpeq_epi32(_mm256_loadu_si256((const __m256i *)(const void *)(p + 8)), all);
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(low)) |
           (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(high)) << 8;
}

static inline uint32_t wide_marked(const uint32_t *p, uint32_t bit) {
    __m256i all = _mm256_set1_epi32((int)bit);
    __m256i low = _mm256_loadu_si256((const __m256i *)(const void *)p);
    __m256i high = _mm256_loadu_si256((const __m256i *)(const void *)(p + 8));
    low = _mm256_cmpeq_epi32(_mm256_and_si256(low, all), all);
    high = _mm256_cmpeq_epi32(_mm256_and_si256(high, all), all);
    return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(low)) |
           (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(high)) << 8;
}

#elif defined(LANES_NEON)

#include <arm_neon.h>

typedef struct lanes {
    float64x2_t part[4];
} lanes;

static inline lanes lanes_load(const double *p) {
    lanes a;
    for (int k = 0; k < 4; k++)
        a.part[k] = vld1q_f64(p + 2 * k);
    return a;
}

static inline lanes lanes_dot(const double w[3], lanes x, lanes y, lanes z) {
    for (int k = 0; k < 4; k++) {
        float64x2_t sum = vmulq_n_f64(x.part[k], w[0]);
        sum = vfmaq_n_f64(sum, y.part[k], w[1]);
        x.part[k] = vfmaq_n_f64(sum, z.part[k], w[2]);
    }
    return x;
}

static inline lanes lanes_beyond(lanes a, lanes b, lanes c, double d) {
    float64x2_t all = vdupq_n_f64(d);
    for (int k = 0; k < 4; k++)
        a.part[k] = vsubq_f64(vaddq_f64(vaddq_f64(a.part[k], b.part[k]), c.part[k]), all);
    return a;
}

/* The second if unordered, like the others. */
static inline lanes lanes_min(lanes a, lanes b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vbslq_f64(vcltq_f64(a.part[k], b.part[k]), a.part[k], b.part[k]);
    return a;
}

static inline uint64_t lanes_mask(const uint64x2_t part[4]) {
    static const uint64_t bits[2] = {1, 2};
    uint64x2_t weights = vld1q_u64(bits);
    uint64_t mask = 0;
    for (int k = 0; k < 4; k++)
        mask |= vaddvq_u64(vandq_u64(part[k], weights)) << (2 * k);
    return mask;
}

static inline uint64_t lanes_above(lanes a, double limit) {
    uint64x2_t above[4];
    for (int k = 0; k < 4; k++)
        above[k] = vcgtq_f64(a.part[k], vdupq_n_f64(limit));
    return lanes_mask(above);
}

static inline uint64_t lanes_beyond_either(lanes a, double limit) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vabsq_f64(a.part[k]);
    return lanes_above(a, limit);
}

static inline lanes lanes_add(lanes a, lanes b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vaddq_f64(a.part[k], b.part[k]);
    return a;
}

/* true is -1: below minus above */
static inline void lanes_store_signs(lanes a, double limit, int8_t *out) {
    for (int k = 0; k < 4; k++) {
        uint64x2_t above = vcgtq_f64(a.part[k], vdupq_n_f64(limit));
        uint64x2_t below = vcltq_f64(a.part[k], vdupq_n_f64(-limit));
        int64x2_t signs = vsubq_s64(vreinterpretq_s64_u64(below), vreinterpretq_s64_u64(above));
        out[2 * k] = (int8_t)vgetq_lane_s64(signs, 0);
        out[2 * k + 1] = (int8_t)vgetq_lane_s64(signs, 1);
    }
}

typedef struct wide {
    float32x4_t part[4];
} wide;

static inline wide wide_load(const float *p) {
    wide a;
    for (int k = 0; k < 4; k++)
        a.part[k] = vld1q_f32(p + 4 * k);
    return a;
}

static inline wide wide_set(float a) {
    wide all;
    for (int k = 0; k < 4; k++)
        all.part[k] = vdupq_n_f32(a);
    return all;
}

static inline wide wide_add(wide a, wide b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vaddq_f32(a.part[k], b.part[k]);
    return a;
}

static inline wide wide_subtract(wide a, wide b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vsubq_f32(a.part[k], b.part[k]);
    return a;
}

static inline wide wide_multiply(wide a, wide b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vmulq_f32(a.part[k], b.part[k]);
    return a;
}

static inline wide wide_abs(wide a) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vabsq_f32(a.part[k]);
    return a;
}

static inline wide wide_min(wide a, wide b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vbslq_f32(vcltq_f32(a.part[k], b.part[k]), a.part[k], b.part[k]);
    return a;
}

static inline wide wide_max(wide a, wide b) {
    for (int k = 0; k < 4; k++)
        a.part[k] = vbslq_f32(vcgtq_f32(a.part[k], b.part[k]), a.part[k], b.part[k]);
    return a;
}

static inline uint32_t wide_mask(const uint32x4_t part[4]) {
    static const uint32_t bits[4] = {1, 2, 4, 8};
    uint32x4_t weights = vld1q_u32(bits);
    uint32_t mask = 0;
    for (int k = 0; k < 4; k++)
        mask |= vaddvq_u32(vandq_u32(part[k], weights)) << (4 * k);
    return mask;
}

static inline uint32_t wide_above(wide a, wide b) {
    uint32x4_t above[4];
    for (int k = 0; k < 4; k++)
        above[k] = vcgtq_f32(a.part[k], b.part[k]);
    return wide_mask(above);
}

static inline uint32_t wide_equal(const uint32_t *p, uint32_t value) {
    uint32x4_t equal[4];
    for (int k = 0; k < 4; k++)
        equal[k] = vceqq_u32(vld1q_u32(p + 4 * k), vdupq_n_u32(value));
    return wide_mask(equal);
}

static inline uint32_t wide_marked(const uint32_t *p, uint32_t bit) {
    uint32x4_t marked[4];
    for (int k = 0; k < 4; k++)
        marked[k] = vtstq_u32(vld1q_u32(p + 4 * k), vdupq_n_u32(bit));
    return wide_mask(marked);
}

#else

#include <math.h>

typedef struct lanes {
    double lane[8];
} lanes;

static inline lanes lanes_load(const double *p) {
    lanes a;
    for (int k = 0; k < 8; k++)
        a.lane[k] = p[k];
    return a;
}

static inline lanes lanes_dot(const double w[3], lanes x, lanes y, lanes z) {
    for (int k = 0; k < 8; k++)
        x.lane[k] = w[0] * x.lane[k] + w[1] * y.lane[k] + w[2] * z.lane[k];
    return x;
}

static inline lanes lanes_beyond(lanes a, lanes b, lanes c, double d) {
    for (int k = 0; k < 8; k++)
        a.lane[k] = a.lane[k] + b.lane[k] + c.lane[k] - d;
    return a;
}

static inline lanes lanes_min(lanes a, lanes b) {
    for (int k = 0; k < 8; k++)
        a.lane[k] = a.lane[k] < b.lane[k] ? a.lane[k] : b.lane[k];
    return a;
}

static inline uint64_t lanes_above(lanes a, double limit) {
    uint64_t mask = 0;
    for (int k = 0; k < 8; k++)
        mask |= (uint64_t)(a.lane[k] > limit) << k;
    return mask;
}

static inline uint64_t lanes_beyond_either(lanes a, double limit) {
    for (int k = 0; k < 8; k++)
        a.lane[k] = fabs(a.lane[k]);
    return lanes_above(a, limit);
}

static inline lanes lanes_add(lanes a, lanes b) {
    for (int k = 0; k < 8; k++)
        a.lane[k] += b.lane[k];
    return a;
}

static inline void lanes_store_signs(lanes a, double limit, int8_t *out) {
    for (int k = 0; k < 8; k++)
        out[k] = (int8_t)((a.lane[k] > limit) - (a.lane[k] < -limit));
}

typedef struct wide {
    float lane[WIDE];
} wide;

static inline wide wide_load(const float *p) {
    wide a;
    for (int k = 0; k < WIDE; k++)
        a.lane[k] = p[k];
    return a;
}

static inline wide wide_set(float a) {
    wide all;
    for (int k = 0; k < WIDE; k++)
        all.lane[k] = a;
    return all;
}

static inline wide wide_add(wide a, wide b) {
    for (int k = 0; k < WIDE; k++)
        a.lane[k] += b.lane[k];
    return a;
}

static inline wide wide_subtract(wide a, wide b) {
    for (int k = 0; k < WIDE; k++)
        a.lane[k] -= b.lane[k];
    return a;
}

static inline wide wide_multiply(wide a, wide b) {
    for (int k = 0; k < WIDE; k++)
        a.lane[k] *= b.lane[k];
    return a;
}

static inline wide wide_abs(wide a) {
    for (int k = 0; k < WIDE; k++)
        a.lane[k] = fabsf(a.lane[k]);
    return a;
}

static inline wide wide_min(wide a, wide b) {
    for (int k = 0; k < WIDE; k++)
        a.lane[k] = a.lane[k] < b.lane[k] ? a.lane[k] : b.lane[k];
    return a;
}

static inline wide wide_max(wide a, wide b) {
    for (int k = 0; k < WIDE; k++)
        a.lane[k] = a.lane[k] > b.lane[k] ? a.lane[k] : b.lane[k];
    return a;
}

static inline uint32_t wide_above(wide a, wide b) {
    uint32_t mask = 0;
    for (int k = 0; k < WIDE; k++)
        mask |= (uint32_t)(a.lane[k] > b.lane[k]) << k;
    return mask;
}

static inline uint32_t wide_equal(const uint32_t *p, uint32_t value) {
    uint32_t mask = 0;
    for (int k = 0; k < WIDE; k++)
        mask |= (uint32_t)(p[k] == value) << k;
    return mask;
}

static inline uint32_t wide_marked(const uint32_t *p, uint32_t bit) {
    uint32_t mask = 0;
    for (int k = 0; k < WIDE; k++)
        mask |= (uint32_t)((p[k] & bit) != 0) << k;
    return mask;
}

#endif

#endif
