/* SPDX-License-Identifier: Apache-2.0 */
/* Exact geometric predicates: the only place that decides signs.
 *
 * Every function returns the sign (-1, 0, 1) of exact arithmetic on the given doubles, for all
 * finite doubles below 1e100 in magnitude, subnormal ones included. A floating-point filter with a
 * proven error bound comes first [She97]; multi-limb integers (geometry/exact.h) decide the rest.
 * Pure functions; any thread. */
#pragma once

#include "core/compiler.h"

#include <stdbool.h>

/* Sign of det(a - d, b - d, c - d): 1 if d lies below the plane of a, b, c, where a, b, c are
 * counter-clockwise seen from above. For a face (a, b, c) that is counter-clockwise from outside, 1
 * means that d is strictly inside of its plane, -1 strictly outside, 0 on it. */
int orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
    STARG_PRIVATE(orient3d);

/* Sign of the turn a, b, c in the plane of coordinates `u` and `v`: 1 for counter-clockwise. */
int orient2d(const double a[3], const double b[3], const double c[3], int u, int v);

/* 1 if e lies strictly inside the sphere through a, b, c, d, -1 outside, 0 on it, given orient3d(a,
 * b, c, d) = 1; opposite signs if it is -1. */
int insphere(const double a[3], const double b[3], const double c[3], const double d[3],
             const double e[3]);

/* Sign of |p - q| - radius, for radius >= 0 (below 1e100). */
int compare_distance(const double p[3], const double q[3], double radius);

/* 1 if q lies strictly in the cone with apex p, axis d (any nonzero length) and the given cosine
 * (-1 to 1) of the half opening angle; 0 on the cone or at p, -1 outside. */
int compare_cone(const double p[3], const double d[3], double cosine, const double q[3]);

/* Sign of n . (q - p): is q before the plane through p with the normal n? */
int compare_plane(const double p[3], const double n[3], const double q[3]);

/* 1 when the angle at q between the line to p and the normal of the triangle a b c on p's side is
 * less than that of a cosine from 0 to 1, 0 when it is the same, -1 when it is more, or p in the
 * plane or on the outer side (orient3d). q lies in the plane. */
int compare_incidence(const double a[3], const double b[3], const double c[3], const double p[3],
                      const double q[3], double cosine);

/* 1 when the angle between p and q, as seen from the centroid of the triangle a b c, is less than
 * that of a cosine from -1 to 1, 0 when it is the same or either is the centroid, else -1. */
int compare_parallax(const double a[3], const double b[3], const double c[3], const double p[3],
                     const double q[3], double cosine);

/* Is the tetrahedron of four points, each moving on a line at constant speed from `from` to `to`,
 * positive at every time: det of the edges from the first corner > 0? True is a proof; false may
 * also mean that the determinant comes within about 1e-14 of zero, relative to the terms of which
 * it is the sum. */
bool stays_positive(const double *const from[4], const double *const to[4])
    STARG_PRIVATE(stays_positive);

/* True when a, b, c lie on one line (or coincide). */
bool collinear(const double a[3], const double b[3], const double c[3]);
