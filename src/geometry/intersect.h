/* SPDX-License-Identifier: Apache-2.0 */
/* Intersections of segments, triangles and points; all degenerate cases are decided exactly. */
#pragma once

#include "core/compiler.h"

#include <stdbool.h>

/* Does the closed triangle a b c meet the half-open segment [p, q)? If so it blocks the view from p
 * to q; touching in q alone does not [YL11, section 3]. Triangles without area count as the
 * segments or points that they are. False when p equals q. */
bool segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                            const double b[3], const double c[3])
    STARG_PRIVATE(segment_meets_triangle);

/* Does point p lie on the closed triangle a b c? */
bool point_on_triangle(const double p[3], const double a[3], const double b[3], const double c[3]);

/* Do the closed segments a b and c d meet? */
bool segments_meet(const double a[3], const double b[3], const double c[3], const double d[3]);

/* How two closed triangles of a mesh meet. */
typedef enum triangle_contact {
    TRIANGLES_APART = 0, /* no common point */
    TRIANGLES_SHARE = 1, /* only the shared corner or edge */
    TRIANGLES_TOUCH = 2, /* other common points, but no edge passes through the other triangle */
    TRIANGLES_CROSS = 3  /* an edge of one passes through the other, or they overlap in a plane */
} triangle_contact;

/* Contact of two triangles with area whose first `shared` corners (0 to 3) are the same mesh
 * vertices. Without shared corners, triangles without area are decided correctly too; with them the
 * result may be wrong. */
triangle_contact triangles_contact(const double *const s[3], const double *const t[3], int shared);
