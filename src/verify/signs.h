/* SPDX-License-Identifier: Apache-2.0 */
/* The geometric decisions of the verifier, all exact for finite doubles below 1e100. Independent of
 * the predicates of the engines: other formulas, other arithmetic (verify/exact_sum.h). */
#ifndef STARG_VERIFY_SIGNS_H
#define STARG_VERIFY_SIGNS_H

#include <stdbool.h>

/* 1 if p is strictly on the inner side of the triangle a b c (counter-clockwise seen from outside),
 * -1 strictly outside, 0 in its plane or if the triangle has no area. */
int verify_side(const double a[3], const double b[3], const double c[3], const double p[3]);

/* 1 if a, b, c are counter-clockwise in the projection along `axis`, -1 clockwise, 0 if collinear
 * there. */
int verify_turn(const double a[3], const double b[3], const double c[3], int axis);

/* Is |p - q| <= radius (radius >= 0, infinity allowed)? */
bool verify_within(const double p[3], const double q[3], double radius);

/* Is |p - q| < radius? */
bool verify_nearer(const double p[3], const double q[3], double radius);

/* Does p lie on the closed triangle t? */
bool verify_on_triangle(const double p[3], const double *const t[3]);

/* Does [p, q) meet the closed triangle t, on which p does not lie? */
bool verify_blocks(const double p[3], const double q[3], const double *const t[3]);
/* The same, given on which side of t p is, as by verify_side. */
bool verify_blocks_from(int p_side, const double p[3], const double q[3], const double *const t[3]);

/* Does t have a point in the tetrahedron (p, face) off the face? Requires p strictly on the inner
 * side of the face, with its corners visible past t. */
bool verify_enters(const double p[3], const double *const face[3], const double *const t[3]);

/* Do two triangles cross: does an edge of one, with ends strictly on both sides of the other's
 * plane, meet the other, or do they overlap in one plane? */
bool verify_cross(const double *const s[3], const double *const t[3]);

#endif
