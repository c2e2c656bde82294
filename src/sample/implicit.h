/* SPDX-License-Identifier: Apache-2.0 */
/* A solid as an implicit function, negative inside: the smooth union of round cones and of outlines
 * that are revolved or extruded, less those that are carved. */
#ifndef STARG_SAMPLE_IMPLICIT_H
#define STARG_SAMPLE_IMPLICIT_H

#include <stdbool.h>
#include <stddef.h>

enum { IMPLICIT_MAX_OUTLINE = 64 };

/* A simple polygon. Revolved, its points are (distance from the axis, height above a); those within
 * the solid at the axis may lie at negative distances. Extruded from a to b, they are coordinates
 * along `flat` and across it. */
typedef struct implicit_outline {
    size_t count;
    bool extruded;
    double points[IMPLICIT_MAX_OUTLINE][2];
} implicit_outline;

/* The convex hull of two balls, optionally flattened; or an outline about the axis from a to b,
 * grown by ra, `rb` thick. */
typedef struct implicit_part {
    double a[3], b[3]; /* centres of the balls */
    double ra, rb;     /* their radii, above 0 */
    double blend;      /* width over which the part blends with earlier ones, above 0 */
    double flat[3];    /* unit direction in which the part is thinner ... */
    double flatten;    /* ... by this factor, at least 1; 0 means 1 */
    const implicit_outline *outline; /* NULL: round cone */
    bool carve;                      /* taken away from what is before it */
    /* derived by implicit_prepare */
    double axis[3], length, sine, cosine; /* of the cone's half-angle */
    double center[3], reach;              /* ball that contains the part */
} implicit_part;

enum { IMPLICIT_MAX_PARTS = 128 };

typedef struct implicit_field {
    size_t count;
    implicit_part parts[IMPLICIT_MAX_PARTS];
} implicit_field;

typedef struct implicit_sample {
    double value;       /* at most the distance to the surface */
    double gradient[3]; /* length at most 1 */
    double radius;      /* of the nearest part: how thin the solid is there */
} implicit_sample;

/* Computes the derived members of a part. */
void implicit_prepare(implicit_part *part);
/* Value of one part alone; `gradient` may be NULL; *radius is that of its axis nearest to p. */
double implicit_part_value(const implicit_part *part, const double p[3], double gradient[3],
                           double *radius);
implicit_sample implicit_evaluate(const implicit_field *field, const double p[3]);
/* Moves p onto the surface by `steps` (> 0) Newton steps; `gradient` is that before the last. */
void implicit_project(const implicit_field *field, double p[3], int steps, double gradient[3]);
/* A box that contains the surface. */
void implicit_bounds(const implicit_field *field, double lower[3], double upper[3]);

#endif
