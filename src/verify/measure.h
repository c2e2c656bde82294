/* SPDX-License-Identifier: Apache-2.0 */
/* Lengths and areas in doubles, in a unit near the size of the model, so that neither huge nor tiny
 * coordinates overflow or underflow. They decide only claims with a tolerance. */
#ifndef STARG_VERIFY_MEASURE_H
#define STARG_VERIFY_MEASURE_H

#include "verify/surface.h"

/* The power of two that brings the model's extent to about 1. */
int verify_scale(const verify_surface *surface);

/* Generous bound on the displacement of a surface point by rounding of coordinates. */
double verify_rounding(const verify_surface *surface);

/* Of the bounds. */
double verify_diagonal(const verify_surface *surface);

/* Area of a face in units of 2^(-2 scale). */
double verify_area(const verify_surface *surface, size_t face, int scale);

/* Same for any triangle. */
double verify_triangle_area(const double a[3], const double b[3], const double c[3], int scale);

/* Area vector, doubled, outward: the normal of a face in the same units. */
void verify_normal(const verify_surface *surface, size_t face, int scale, double n[3]);

/* A sum of volumes of tetrahedra in units of 2^(-3 scale), and a bound on its rounding error. */
typedef struct verify_volume {
    double sum, rest, slack;
} verify_volume;

/* Adds a tetrahedron by its corners; an inverted one is negative. */
void verify_add_volume(verify_volume *own, const double *const t[4], int scale);

static inline double verify_volume_value(const verify_volume *own) {
    return own->sum + own->rest;
}

/* Does it match the claimed volume, up to a billionth, rounding, and `slack`? */
bool verify_same_volume(const verify_volume *own, double claimed, double slack);

/* Squared distance from p to a face, in units of 2^(-2 scale). */
double verify_squared_distance(const verify_surface *surface, size_t face, const double p[3],
                               int scale);

/* Distance from p to the nearest face, in the model's own unit. */
double verify_distance(const verify_surface *surface, const double p[3], size_t faces, int scale);

#endif
