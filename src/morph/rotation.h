/* SPDX-License-Identifier: Apache-2.0 */
/* 3 x 3 matrices, row-major: rotations, and the rotational part of other maps. */
#pragma once

/* Eigenvalues of a symmetric matrix in descending order, unit eigenvectors in the columns of
 * `vectors`, a right-handed frame. By Jacobi rotations. */
void symmetric_eigen(const double matrix[9], double values[3], double vectors[9]);

/* The rotation nearest to m: the R of the polar decomposition m = R S, with S symmetric, of
 * positive trace if possible; proper also if m is singular or mirrors. */
void polar_rotation(const double m[9], double rotation[9]);

/* The axis times the angle in [0, pi], and back. */
void rotation_to_vector(const double rotation[9], double vector[3]);
void rotation_from_vector(const double vector[3], double rotation[9]);

/* The vector of the same rotation nearest to `near`: its angle may exceed pi. */
void rotation_vector_near(const double near[3], double vector[3]);

/* out = a b, out = a^T b; out must not alias. */
void matrix_multiply(const double a[9], const double b[9], double out[9]);
void matrix_multiply_transposed(const double a[9], const double b[9], double out[9]);

/* out = m v; out may be v. */
void matrix_apply(const double m[9], const double v[3], double out[3]);
