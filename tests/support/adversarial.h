/* SPDX-License-Identifier: Apache-2.0 */
/* Point families that break careless geometry: lattices, near degeneracies, extreme scales. */
#ifndef TESTS_ADVERSARIAL_H
#define TESTS_ADVERSARIAL_H

#include <stddef.h>

#include "core/rng.h"

typedef enum point_family {
    POINTS_UNIFORM,     /* in a cube */
    POINTS_LATTICE,     /* integers 0 to 3: coplanar, collinear, cospherical, equal */
    POINTS_TINY,        /* integers -1 to 1 */
    POINTS_PLANE,       /* in a plane up to rounding, some moved by an ulp */
    POINTS_LINE,        /* on a line, likewise */
    POINTS_SPHERE,      /* on a sphere, likewise */
    POINTS_FAR_LATTICE, /* multiples of 0.1 about 1e8 */
    POINTS_1E_300,      /* a lattice times 1e-300 */
    POINTS_SUBNORMAL,   /* a lattice times 5e-324 */
    POINTS_1E90,        /* a lattice times 1e90 */
    POINTS_9E99,        /* anything up to 9e99 */
    POINTS_MIXED,       /* coordinates of all these scales mixed */
    POINTS_EXPONENTS,   /* any 53 bits, and every exponent from the smallest up to 1e99 */
    POINTS_ULPS,        /* all within two ulps of one point */
    POINTS_BETWEEN,     /* exactly on edges and in planes of earlier points, or an ulp off */
    POINT_FAMILIES
} point_family;

/* A name for messages. */
const char *point_family_name(point_family family);

/* Fills `count` points; some repeat an earlier point or one of its coordinates. */
void adversarial_points(starg_rng *rng, point_family family, double (*points)[3], size_t count);

#endif
