/* SPDX-License-Identifier: Apache-2.0 */
/* The arithmetic of the checks: sums without rounding, and exact signs. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* ---- exact sums of products of three doubles, their signs and values (exact_sum.c) ---- */

/* Bit 0 is worth 2^(-3 x 1074); 2^32 products below 2^1083 need 3222 + 1115 bits. */
enum { EXACT_SUM_WORDS = 68 };

typedef struct exact_sum {
    uint64_t plus[EXACT_SUM_WORDS], minus[EXACT_SUM_WORDS];
} exact_sum;

void exact_sum_clear(exact_sum *sum);

/* sum += a b c, for finite factors below 2^361 in magnitude. */
void exact_sum_add(exact_sum *sum, double a, double b, double c);

/* sum += det(a, b, c), six products. */
void exact_sum_add_determinant(exact_sum *sum, const double a[3], const double b[3],
                               const double c[3]);

/* sum += other */
void exact_sum_add_sum(exact_sum *sum, const exact_sum *other);

/* -1, 0 or 1. */
int exact_sum_sign(const exact_sum *sum);

/* The sum times 2^scale, rounded: off by less than 2^-52 of it. */
double exact_sum_value(const exact_sum *sum, int scale);

/* ---- the geometric decisions of the verifier (signs.c) ---- */
/* All exact for finite doubles below 1e100. Independent of the predicates of the engines: other
 * formulas, other arithmetic. */

/* What is looked at: a point, or one between the vertices of a face, which lies in its plane as its
 * doubles do not. Signs are those of the point itself. */
#define VERIFY_UNIT 0x1p28
enum { VERIFY_UNIT_BITS = 28 };

typedef struct verify_spot {
    const double *at;        /* rounded if it is between vertices */
    double blur;             /* what these coordinates are off at most; 0: a plain point */
    const double *corner[3]; /* else its vertices, and their weights: whole, VERIFY_UNIT in sum */
    double weight[3];
} verify_spot;

static inline verify_spot verify_plain(const double p[3]) {
    return (verify_spot){.at = p};
}

/* 1 if p is strictly on the inner side of the triangle a b c (counter-clockwise seen from outside),
 * -1 strictly outside, 0 in its plane or if the triangle has no area. */
int verify_side(const double a[3], const double b[3], const double c[3], const double p[3]);

/* 1 if a, b, c are counter-clockwise in the projection along `axis`, -1 clockwise, 0 if collinear
 * there. */
int verify_turn(const double a[3], const double b[3], const double c[3], int axis);

/* The same of a spot, as the last point. */
int verify_spot_side(const double a[3], const double b[3], const double c[3], const verify_spot *q);
int verify_spot_turn(const double a[3], const double b[3], const verify_spot *q, int axis);

/* Sign of coordinate k of a spot minus x. */
int verify_spot_compare(const verify_spot *q, int k, double x);

/* Is |p - q| <= radius (radius >= 0, infinity allowed)? */
bool verify_within(const double p[3], const double q[3], double radius);

/* Is |p - q| < radius? */
bool verify_nearer(const double p[3], const double q[3], double radius);

/* Does p lie on the closed triangle t? */
bool verify_on_triangle(const double p[3], const double *const t[3]);

/* Does [p, q) meet the closed triangle t, on which p does not lie? */
bool verify_blocks(const double p[3], const double q[3], const double *const t[3]);
/* The same, given on which side of t p is, as by verify_side. */
bool verify_blocks_from(int p_side, const double p[3], const verify_spot *q,
                        const double *const t[3]);

/* Does t have a point in the tetrahedron (p, part) off the part, which is all of a face or a
 * triangle in it, turned alike? Requires p strictly on the inner side of the face, with the corners
 * of the part visible past t. */
bool verify_enters(const double p[3], const double *const face[3], const verify_spot part[3],
                   const double *const t[3]);

/* Do two triangles cross: does an edge of one, with ends strictly on both sides of the other's
 * plane, meet the other, or do they overlap in one plane? */
bool verify_cross(const double *const s[3], const double *const t[3]);
/* Does an edge of one pass through the inside of the other? */
bool verify_pierce(const double *const s[3], const double *const t[3]);
