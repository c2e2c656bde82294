/* SPDX-License-Identifier: Apache-2.0 */
/* Points with rational coordinates: intersections of lines through vertices and planes through
 * faces.
 *
 * A point is four integers (x, y, z, w) with w > 0 in units of a common power of two (the scale):
 * its coordinates are x/w, y/w, z/w times 2^scale. The nearest double of each coordinate is stored
 * too. Rounding is monotone, so different doubles decide an order, and equal points have equal
 * doubles. All signs are exact: a filter on the doubles first, then integers.
 *
 * Planes pass through three vertices and lines through two, which keeps numbers short: a vertex has
 * degree 1 in the coordinates, the intersection of a line and a plane degree 4 / 3, that of three
 * planes 7 / 6, and the largest sign needed has degree 21. Coordinates of up to EXACT_POINT_BITS
 * bits fit. */
#pragma once

#include "core/memory.h"
#include "geometry/exact.h"

/* Largest width of the coordinates (exact_scale). */
enum { EXACT_POINT_BITS = 360 };

typedef struct exact_point {
    exact x[4];
    double rounded[3];
} exact_point;

/* normal . x = offset; the three defining points are counter-clockwise seen from the side to which
 * the normal points. */
typedef struct exact_plane {
    exact normal[3], offset;
} exact_plane;

void exact_plane_set(exact_plane *out, const double *const corner[3], int scale);

void exact_point_set(exact_point *out, const double p[3], int scale);
/* Intersection of line p q and the plane, in which they do not both lie. */
void exact_point_on_plane(exact_point *out, const double p[3], const double q[3],
                          const exact_plane *plane, int scale);
/* Intersection of lines p q and a b, whose common plane projects injectively to (u, v). */
void exact_point_on_line(exact_point *out, const double p[3], const double q[3], const double a[3],
                         const double b[3], int u, int v, int scale);
/* Intersection of three planes in one point. */
void exact_point_of_planes(exact_point *out, const exact_plane *const plane[3], int scale);
/* Barycentric combination: weight[0] a + weight[1] b + weight[2] c over the sum of the weights, all
 * above 0. */
void exact_point_between(exact_point *out, const exact_point *const corner[3],
                         const uint32_t weight[3], int scale);

/* Sign of the turn a, b, c in the plane of coordinates u and v: 1 for counter-clockwise. */
int exact_turn(const exact_point *a, const exact_point *b, const exact_point *c, int u, int v);
/* 1 if the point lies strictly on the side to which the plane's normal points, -1 on the other. */
int exact_side(const exact_plane *plane, const exact_point *point);

/* ---- a set of points ---- */

typedef struct exact_entry {
    double rounded[3];
    size_t limb;      /* offset of the integers */
    int16_t count[4]; /* limbs of each coordinate, negative for a negative number */
} exact_entry;

/* Distinct points, numbered. */
typedef struct exact_points {
    starg_context *context;
    int scale;
    STARG_ARRAY(exact_entry) points;
    STARG_ARRAY(uint64_t) limbs;
    uint32_t *slots; /* point + 1, or 0; open addressing, by the rounded coordinates */
    size_t slot_count;
} exact_points;

void exact_points_free(exact_points *set);
/* Returns the number of a point, adding it if it is new. Errors: MEMORY. */
starg_status exact_points_add(exact_points *set, const exact_point *point, uint32_t *number);
void exact_points_get(const exact_points *set, uint32_t number, exact_point *out);
static inline const double *exact_points_rounded(const exact_points *set, uint32_t number) {
    return set->points.data[number].rounded;
}

/* exact_turn of three points of the set. */
int exact_points_turn(const exact_points *set, uint32_t a, uint32_t b, uint32_t c, int u, int v);
/* Sign of the difference a - b of coordinate k. */
int exact_points_compare(const exact_points *set, uint32_t a, uint32_t b, int k);
