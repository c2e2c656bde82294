/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/surface.h"

#include <math.h>

int verify_scale(const verify_surface *surface) {
    double extent = 0;
    for (int k = 0; k < 3; k++)
        extent = fmax(extent, surface->upper[k] - surface->lower[k]);
    return extent > 0 ? -ilogb(extent) : 0;
}

double verify_rounding(const verify_surface *surface) {
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, fmax(fabs(surface->lower[k]), fabs(surface->upper[k])));
    return size * 0x1p-50;
}

double verify_diagonal(const verify_surface *surface) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum = hypot(sum, surface->upper[k] - surface->lower[k]);
    return sum;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* out = 2^scale (a - b) */
static void scaled_difference(const double a[3], const double b[3], int scale, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = ldexp(a[k] - b[k], scale);
}

/* Of a tetrahedron; negative if inverted. */
static double volume_of(const double a[3], const double b[3], const double c[3], const double d[3],
                        int scale) {
    double u[3], v[3], w[3], n[3];
    scaled_difference(b, a, scale, u);
    scaled_difference(c, a, scale, v);
    scaled_difference(d, a, scale, w);
    cross(u, v, n);
    return dot(n, w) / 6;
}

static void normal_of(const double a[3], const double b[3], const double c[3], int scale,
                      double n[3]) {
    double u[3], v[3];
    scaled_difference(b, a, scale, u);
    scaled_difference(c, a, scale, v);
    cross(u, v, n);
}

void verify_normal(const verify_surface *surface, size_t face, int scale, double n[3]) {
    const double *t[3];
    verify_corners(surface, face, t);
    normal_of(t[0], t[1], t[2], scale, n);
}

double verify_triangle_area(const double a[3], const double b[3], const double c[3], int scale) {
    double n[3];
    normal_of(a, b, c, scale, n);
    return 0.5 * sqrt(dot(n, n));
}

double verify_area(const verify_surface *surface, size_t face, int scale) {
    const double *t[3];
    verify_corners(surface, face, t);
    return verify_triangle_area(t[0], t[1], t[2], scale);
}

/* Compensated summation [Neumaier 1974]. */
static void add(verify_volume *own, double x) {
    double sum = own->sum + x;
    own->rest += fabs(own->sum) >= fabs(x) ? (own->sum - sum) + x : (x - sum) + own->sum;
    own->sum = sum;
}

void verify_add_volume(verify_volume *own, const double *const t[4], int scale) {
    double box = 1;
    for (int k = 0; k < 3; k++) {
        double lower = fmin(fmin(t[0][k], t[1][k]), fmin(t[2][k], t[3][k]));
        double upper = fmax(fmax(t[0][k], t[1][k]), fmax(t[2][k], t[3][k]));
        box *= ldexp(upper - lower, scale);
    }
    add(own, volume_of(t[0], t[1], t[2], t[3], scale));
    own->slack += 0x1p-48 * box;
}

bool verify_same_volume(const verify_volume *own, double claimed, double slack) {
    double value = verify_volume_value(own);
    return fabs(value - claimed) <= 1e-9 * fmax(fabs(value), fabs(claimed)) + own->slack + slack;
}

/* Squared distance from the origin to the segment from a along e. */
static double squared_to_segment(const double a[3], const double e[3]) {
    double length = dot(e, e);
    double s = length > 0 ? fmin(1, fmax(0, -dot(a, e) / length)) : 0;
    double foot[3] = {a[0] + s * e[0], a[1] + s * e[1], a[2] + s * e[2]};
    return dot(foot, foot);
}

/* Squared distance from the origin to a triangle: to its plane if the foot is in the triangle,
 * otherwise to its edges. */
static double squared_to_triangle(double a[3][3]) {
    double e[3][3], n[3], side[3], least = INFINITY;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = a[(i + 1) % 3][k] - a[i][k];
    cross(e[0], e[1], n);
    bool above = dot(n, n) > 0;
    for (int i = 0; i < 3; i++) {
        least = fmin(least, squared_to_segment(a[i], e[i]));
        cross(a[i], a[(i + 1) % 3], side);
        above = above && dot(side, n) >= 0;
    }
    double height = dot(a[0], n);
    return above ? fmin(least, height * (height / dot(n, n))) : least;
}

double verify_squared_distance(const verify_surface *surface, size_t face, const double p[3],
                               int scale) {
    const double *t[3];
    double a[3][3];
    verify_corners(surface, face, t);
    for (int i = 0; i < 3; i++)
        scaled_difference(t[i], p, scale, a[i]);
    return squared_to_triangle(a);
}

double verify_distance(const verify_surface *surface, const double p[3], size_t faces, int scale) {
    double least = INFINITY;
    for (size_t f = 0; f < faces; f++)
        least = fmin(least, verify_squared_distance(surface, f, p, scale));
    return ldexp(sqrt(least), -scale);
}
