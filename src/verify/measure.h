/* Lengths and areas in doubles, in a unit near the size of the model, so that neither huge nor
 * tiny coordinates leave the range. They decide nothing but claims with a tolerance. */
#ifndef STARG_VERIFY_MEASURE_H
#define STARG_VERIFY_MEASURE_H

#include "verify/surface.h"

/* The power of two that brings the model's extent to about 1. */
int verify_scale(const verify_surface *surface);

/* Area of a face in units of 2^(-2 scale). */
double verify_area(const verify_surface *surface, size_t face, int scale);

/* Distance from p to the nearest face, in the model's own unit. */
double verify_distance(const verify_surface *surface, const double p[3], int scale);

#endif
