/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors of three doubles. They decide no signs: see predicates.h. */
#pragma once

#include <math.h>
#include <stdbool.h>

static inline void vec3_copy(const double a[3], double out[3]) {
    out[0] = a[0];
    out[1] = a[1];
    out[2] = a[2];
}

static inline void vec3_subtract(const double a[3], const double b[3], double out[3]) {
    out[0] = a[0] - b[0];
    out[1] = a[1] - b[1];
    out[2] = a[2] - b[2];
}

/* out = a + t b */
static inline void vec3_along(const double a[3], double t, const double b[3], double out[3]) {
    out[0] = a[0] + t * b[0];
    out[1] = a[1] + t * b[1];
    out[2] = a[2] + t * b[2];
}

static inline double vec3_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vec3_cross(const double a[3], const double b[3], double out[3]) {
    double x = a[1] * b[2] - a[2] * b[1];
    double y = a[2] * b[0] - a[0] * b[2];
    double z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/* a . (b x c), six times the volume of the tetrahedron (0, a, b, c). */
static inline double vec3_triple(const double a[3], const double b[3], const double c[3]) {
    double n[3];
    vec3_cross(b, c, n);
    return vec3_dot(a, n);
}

static inline double vec3_length(const double a[3]) {
    return sqrt(vec3_dot(a, a));
}

/* Makes the length one; returns what it was. */
static inline double vec3_normalize(double v[3]) {
    double length = vec3_length(v);
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return length;
}

static inline bool vec3_equal(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static inline double vec3_distance_squared(const double a[3], const double b[3]) {
    double d[3];
    vec3_subtract(a, b, d);
    return vec3_dot(d, d);
}

static inline double vec3_distance(const double a[3], const double b[3]) {
    return sqrt(vec3_distance_squared(a, b));
}

/* Area vector of a triangle, doubled: length twice the area, direction the normal. */
static inline void vec3_triangle_normal(const double a[3], const double b[3], const double c[3],
                                        double out[3]) {
    double u[3], v[3];
    vec3_subtract(b, a, u);
    vec3_subtract(c, a, v);
    vec3_cross(u, v, out);
}

static inline double vec3_triangle_area(const double a[3], const double b[3], const double c[3]) {
    double n[3];
    vec3_triangle_normal(a, b, c, n);
    return 0.5 * vec3_length(n);
}

/* Two directions across a unit vector, at right angles. */
static inline void vec3_axes_across(const double normal[3], double axes[2][3]) {
    int least = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    least = fabs(normal[2]) < fabs(normal[least]) ? 2 : least;
    const double unit[3] = {least == 0, least == 1, least == 2};
    vec3_cross(normal, unit, axes[0]);
    double length = vec3_length(axes[0]);
    for (int k = 0; k < 3; k++)
        axes[0][k] /= length;
    vec3_cross(normal, axes[0], axes[1]);
}
