/* Lengths and areas in doubles, in a unit near the size of the model, so that neither huge nor
 * tiny coordinates leave the range. They decide nothing but claims with a tolerance. */
#ifndef STARG_VERIFY_MEASURE_H
#define STARG_VERIFY_MEASURE_H

#include "verify/surface.h"

/* The power of two that brings the model's extent to about 1. */
int verify_scale(const verify_surface *surface);

/* Area of a face in units of 2^(-2 scale). */
double verify_area(const verify_surface *surface, size_t face, int scale);

/* Twice the area, outward: the normal of a face in the same units. */
void verify_normal(const verify_surface *surface, size_t face, int scale, double n[3]);

/* Volume of a tetrahedron in units of 2^(-3 scale), negative when it is inverted. */
double verify_volume(const double a[3], const double b[3], const double c[3], const double d[3],
                     int scale);

/* A sum with its rounding errors kept aside [Neumaier 1974]; it is sum + rest. */
typedef struct verify_total {
    double sum, rest;
} verify_total;

void verify_total_add(verify_total *total, double x);

static inline double verify_total_value(verify_total total) {
    return total.sum + total.rest;
}

/* Squared distance from p to a face, in units of 2^(-2 scale). */
double verify_squared_distance(const verify_surface *surface, size_t face, const double p[3],
                               int scale);

/* Distance from p to the nearest face, in the model's own unit. */
double verify_distance(const verify_surface *surface, const double p[3], int scale);

#endif
