/* Eight doubles at a time, in the form that the including file has chosen by LANES_PLAIN,
 * LANES_AVX2 or LANES_AVX512. Bit k of a mask stands for lane k; comparisons with NaN are false. */
#ifndef STARG_VISIBILITY_LANES_H
#define STARG_VISIBILITY_LANES_H

#include <stdint.h>

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

#endif

#endif
