/* SPDX-License-Identifier: Apache-2.0 */
/* Points between three vertices, with weights that are multiples of a power of two: corners of the
 * parts that a triangle is cut into by halving edges.
 *
 * x = (w0 a + w1 b + w2 c) / 2^depth with whole weights whose sum is 2^depth. Such a point lies in
 * the plane of a, b and c, where its nearest doubles do not; so signs are those of the point
 * itself: a filter on the doubles first, with what they are off added to its bound, then integers
 * of 2^depth times all coordinates. Where the doubles are the point, they are used alone. */
#pragma once

#include "core/compiler.h"

#include <stdbool.h>
#include <stdint.h>

enum { DYADIC_DEPTH = 30 };

typedef struct dyadic_point {
    const double *corner[3];
    uint32_t weight[3]; /* 0 at corners that do not matter, which may be NULL */
    int depth;          /* up to DYADIC_DEPTH */
    bool exact;         /* `at` is the point; a plain point has nothing else */
    double at[3];       /* within `blur` of it */
    double blur;        /* 0 if exact */
} dyadic_point;

/* A plain point. */
static inline dyadic_point dyadic_of(const double p[3]) {
    return (dyadic_point){.exact = true, .at = {p[0], p[1], p[2]}};
}

/* What rounded coordinates of points between vertices are off at most, if no coordinate of a vertex
 * is larger. */
static inline double dyadic_blur(double largest) {
    return 0x1p-50 * largest + 0x1p-1000;
}

/* Sets `at`, `exact` and `blur` by the rest. Equal points by equal weights in the same order have
 * equal doubles. */
void dyadic_round(dyadic_point *point);

/* orient3d of such points. */
int dyadic_orient3d(const dyadic_point *a, const dyadic_point *b, const dyadic_point *c,
                    const dyadic_point *d);

/* segment_meets_triangle, to such a point q. */
bool dyadic_segment_meets_triangle(const double p[3], const dyadic_point *q, const double a[3],
                                   const double b[3], const double c[3]);
