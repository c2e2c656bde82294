/* SPDX-License-Identifier: Apache-2.0 */
/* Singular values of a map between two frames of three vectors: the matrix of the map, then
 * one-sided Jacobi rotations (Hestenes 1958). Where frames are flat, the matrix is off by a share
 * of its largest value, which may be more than the smallest; that is taken from the inverse map,
 * whose largest value it is, where rounding spoils it less. */
#include "geometry/singular_values.h"

#include "geometry/vec3.h"

enum { SWEEPS = 12 };

/* Columns of the matrix: images of the axes. The rows of the inverse of `from` are cross products
 * of its columns over its determinant. */
static void matrix_of(double from[3][3], double to[3][3], double columns[3][3]) {
    double dual[3][3];
    for (int i = 0; i < 3; i++)
        vec3_cross(from[(i + 1) % 3], from[(i + 2) % 3], dual[i]);
    double determinant = vec3_dot(from[0], dual[0]);
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int i = 0; i < 3; i++)
                sum += to[i][k] * dual[i][axis];
            columns[axis][k] = sum / determinant;
        }
}

/* Turns two columns in their plane so that they become orthogonal. */
static void rotate(double a[3], double b[3]) {
    double dot = vec3_dot(a, b), alpha = vec3_dot(a, a), beta = vec3_dot(b, b);
    if (fabs(dot) <= 1e-16 * sqrt(alpha * beta))
        return;
    double zeta = (beta - alpha) / (2 * dot);
    double t = copysign(1, zeta) / (fabs(zeta) + sqrt(1 + zeta * zeta));
    double c = 1 / sqrt(1 + t * t), s = c * t;
    for (int k = 0; k < 3; k++) {
        double x = a[k], y = b[k];
        a[k] = c * x - s * y;
        b[k] = s * x + c * y;
    }
}

static void swap_if_less(double *a, double *b) {
    double larger = fmax(*a, *b);
    *b = fmin(*a, *b);
    *a = larger;
}

static void values_of(double from[3][3], double to[3][3], double out[3]) {
    double columns[3][3];
    matrix_of(from, to, columns);
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int i = 0; i < 3; i++)
            rotate(columns[i], columns[(i + 1) % 3]);
    for (int k = 0; k < 3; k++)
        out[k] = vec3_length(columns[k]);
    swap_if_less(&out[0], &out[1]);
    swap_if_less(&out[1], &out[2]);
    swap_if_less(&out[0], &out[1]);
}

/* Determinant over the product of lengths: rounding is divided by it. */
static double flatness(double m[3][3]) {
    double across[3];
    vec3_cross(m[1], m[2], across);
    return fabs(vec3_dot(m[0], across)) /
           (vec3_length(m[0]) * vec3_length(m[1]) * vec3_length(m[2]));
}

void singular_values(double from[3][3], double to[3][3], double out[3]) {
    double inverse[3];
    values_of(from, to, out);
    if (!(out[2] * flatness(from) < out[0] * flatness(to)))
        return;
    values_of(to, from, inverse);
    out[2] = fmin(1 / inverse[0], out[1]);
}
