/* SPDX-License-Identifier: Apache-2.0 */
/* Rotations from 3 x 3 matrices, for morphing [ACOL00]. */
#include "morph/morph.h"

#include <string.h>

#include "geometry/vec3.h"

enum { SWEEPS = 24 };
static const double PI = 3.14159265358979323846;

void matrix_multiply(const double a[9], const double b[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

void matrix_multiply_transposed(const double a[9], const double b[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
}

void matrix_apply(const double m[9], const double v[3], double out[3]) {
    const double x[3] = {vec3_dot(m, v), vec3_dot(m + 3, v), vec3_dot(m + 6, v)};
    vec3_copy(x, out);
}

/* Zeroes entry (p, q) of a by a rotation in that plane, and rotates the columns of v along. */
static void jacobi_rotate(double a[9], double v[9], int p, int q) {
    double off = a[3 * p + q];
    if (off == 0)
        return;
    double theta = (a[4 * q] - a[4 * p]) / (2 * off);
    double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
    double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; k++) {
        double x = a[3 * k + p], y = a[3 * k + q];
        a[3 * k + p] = c * x - s * y;
        a[3 * k + q] = s * x + c * y;
    }
    for (int k = 0; k < 3; k++) {
        double x = a[3 * p + k], y = a[3 * q + k];
        a[3 * p + k] = c * x - s * y;
        a[3 * q + k] = s * x + c * y;
    }
    for (int k = 0; k < 3; k++) {
        double x = v[3 * k + p], y = v[3 * k + q];
        v[3 * k + p] = c * x - s * y;
        v[3 * k + q] = s * x + c * y;
    }
}

void symmetric_eigen(const double matrix[9], double values[3], double vectors[9]) {
    double a[9], v[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    int order[3] = {0, 1, 2};
    memcpy(a, matrix, sizeof a);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        jacobi_rotate(a, v, 0, 1);
        jacobi_rotate(a, v, 0, 2);
        jacobi_rotate(a, v, 1, 2);
    }
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (a[4 * order[j]] < a[4 * order[j + 1]]) {
                int swap = order[j];
                order[j] = order[j + 1];
                order[j + 1] = swap;
            }
    double x[3][3];
    for (int i = 0; i < 3; i++) {
        values[i] = a[4 * order[i]];
        for (int k = 0; k < 3; k++)
            x[i][k] = v[3 * k + order[i]];
    }
    vec3_cross(x[0], x[1], x[2]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            vectors[3 * k + i] = x[i][k];
}

/* A unit vector orthogonal to u. */
static void any_normal(const double u[3], double out[3]) {
    int k = fabs(u[0]) < fabs(u[1]) ? 0 : 1;
    if (fabs(u[2]) < fabs(u[k]))
        k = 2;
    double axis[3] = {k == 0, k == 1, k == 2};
    vec3_cross(u, axis, out);
    double length = vec3_length(out);
    for (int i = 0; i < 3; i++)
        out[i] /= length;
}

/* v orthogonalized against the unit vector u and normalized; any normal of u if nothing is left. */
static void make_normal(const double u[3], double v[3]) {
    double before = vec3_length(v);
    vec3_along(v, -vec3_dot(u, v), u, v);
    double length = vec3_length(v);
    if (!(length > 1e-14 * before)) {
        any_normal(u, v);
        return;
    }
    for (int k = 0; k < 3; k++)
        v[k] /= length;
}

/* m = U D V^T with D descending: U V^T, where the last column of each is the cross product of the
 * two others. */
void polar_rotation(const double m[9], double rotation[9]) {
    double gram[9], values[3], v[9], u[3][3];
    matrix_multiply_transposed(m, m, gram);
    symmetric_eigen(gram, values, v);
    for (int i = 0; i < 2; i++) {
        const double column[3] = {v[i], v[3 + i], v[6 + i]};
        matrix_apply(m, column, u[i]);
    }
    double length = vec3_length(u[0]);
    for (int k = 0; k < 3; k++)
        u[0][k] = length > 0 ? u[0][k] / length : v[3 * k];
    make_normal(u[0], u[1]);
    vec3_cross(u[0], u[1], u[2]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            rotation[3 * i + k] =
                u[0][i] * v[3 * k] + u[1][i] * v[3 * k + 1] + u[2][i] * v[3 * k + 2];
}

/* Uses the largest component of the unit quaternion, which is stable at every angle. */
void rotation_to_vector(const double r[9], double vector[3]) {
    double trace = r[0] + r[4] + r[8];
    double squares[4] = {1 + trace, 1 - trace + 2 * r[0], 1 - trace + 2 * r[4],
                         1 - trace + 2 * r[8]};
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (squares[i] > squares[best])
            best = i;
    double q[4] = {r[7] - r[5], r[2] - r[6], r[3] - r[1], 0}; /* times 4 w; the last is w */
    if (best == 0) {
        q[3] = squares[0];
    } else {
        int i = best - 1, j = (i + 1) % 3, k = (i + 2) % 3;
        q[3] = q[i];
        q[i] = squares[best];
        q[j] = r[3 * i + j] + r[3 * j + i];
        q[k] = r[3 * i + k] + r[3 * k + i];
    }
    double sine = vec3_length(q), sign = q[3] < 0 ? -1 : 1;
    double angle = 2 * atan2(sine, fabs(q[3]));
    for (int k = 0; k < 3; k++)
        vector[k] = sine > 0 ? sign * angle * q[k] / sine : 0;
}

void rotation_from_vector(const double vector[3], double r[9]) {
    double angle = vec3_length(vector), axis[3] = {1, 0, 0};
    for (int k = 0; k < 3 && angle > 0; k++)
        axis[k] = vector[k] / angle;
    double c = cos(angle), s = sin(angle), d = 2 * sin(angle / 2) * sin(angle / 2);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            r[3 * i + k] = d * axis[i] * axis[k] + (i == k ? c : 0);
    r[1] -= s * axis[2];
    r[2] += s * axis[1];
    r[3] += s * axis[2];
    r[5] -= s * axis[0];
    r[6] -= s * axis[1];
    r[7] += s * axis[0];
}

void rotation_vector_near(const double near[3], double vector[3]) {
    double angle = vec3_length(vector), axis[3];
    if (!(angle > 1e-9)) /* the axis is undefined: use that of `near` */
        vec3_copy(near, axis);
    else
        vec3_copy(vector, axis);
    double length = vec3_length(axis);
    if (!(length > 0))
        return;
    for (int k = 0; k < 3; k++)
        axis[k] /= length;
    angle = vec3_dot(vector, axis);
    double turns = round((vec3_dot(near, axis) - angle) / (2 * PI));
    for (int k = 0; k < 3; k++)
        vector[k] += 2 * PI * turns * axis[k];
}
