/* SPDX-License-Identifier: Apache-2.0 */
/* Exact geometric predicates: the one place where signs are decided.
 *
 * Every function returns the sign (-1, 0, 1) that exact arithmetic on the given doubles would
 * give, for all finite doubles below 1e100 in magnitude, subnormal ones included. A floating-point
 * filter with a proven error bound answers first [She97]; what it cannot decide goes to integers
 * of as many limbs as it takes (geometry/exact.h). Pure functions; any thread. */
#ifndef STARG_GEOMETRY_PREDICATES_H
#define STARG_GEOMETRY_PREDICATES_H

#include "core/private.h"

#include <stdbool.h>

/* Sign of det(a - d, b - d, c - d): 1 when d lies below the plane of a, b, c, seen so that a, b, c
 * turn counter-clockwise. For a face (a, b, c) that is counter-clockwise from outside, 1 means that
 * d is strictly on its inner side, -1 strictly outside, 0 in its plane. */
int orient3d(const double a[3], const double b[3], const double c[3], const double d[3])
    STARG_PRIVATE(orient3d);

/* Sign of the turn a, b, c in the plane of coordinates `u` and `v`: 1 for counter-clockwise. */
int orient2d(const double a[3], const double b[3], const double c[3], int u, int v);

/* 1 when e lies strictly inside the sphere through a, b, c, d, -1 outside, 0 on it, given
 * orient3d(a, b, c, d) = 1; the opposite when it is -1. */
int insphere(const double a[3], const double b[3], const double c[3], const double d[3],
             const double e[3]);

/* Sign of |p - q| - radius, for radius >= 0 (below 1e100). */
int compare_distance(const double p[3], const double q[3], double radius);

/* 1 when q lies strictly within the cone of p about the direction d (any length but 0), whose half
 * opening angle has the given cosine, from -1 to 1; 0 on its side or at p, -1 outside. */
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

/* True when a, b, c lie on one line (or coincide). */
bool collinear(const double a[3], const double b[3], const double c[3]);

#endif
