/* SPDX-License-Identifier: Apache-2.0 */
/* Round cones and their smooth union.
 *
 * The distance to a round cone is computed in the half-plane through its axis: there the outline is
 * two arcs joined by their common tangent. Parts are joined one by one by the quadratic smooth
 * minimum, which differs from the minimum only where the two values are closer than the blend; so
 * skipping a distant part does not change the value by a bit. Both have Lipschitz constant 1, which
 * lets the mesher skip empty space. */
#include "sample/implicit.h"

#include <math.h>
#include <stdbool.h>

#include "geometry/vec3.h"

void implicit_prepare(implicit_part *part) {
    if (part->flatten < 1)
        part->flatten = 1;
    vec3_subtract(part->b, part->a, part->axis);
    part->length = vec3_length(part->axis);
    for (int k = 0; k < 3; k++) {
        part->axis[k] = part->length > 0 ? part->axis[k] / part->length : k == 0;
        part->center[k] = 0.5 * (part->a[k] + part->b[k]);
    }
    part->reach = 0.5 * part->length + fmax(part->ra, part->rb);
    /* if one ball contains the other, sine = +-1 and one of the caps covers all */
    double sine = part->length > 0 ? (part->ra - part->rb) / part->length : 0;
    part->sine = fmax(-1, fmin(1, sine));
    part->cosine = sqrt(1 - part->sine * part->sine);
}

/* Distance to the ball, and its gradient. */
static double ball_value(const double p[3], const double center[3], double radius,
                         double gradient[3]) {
    vec3_subtract(p, center, gradient);
    double length = vec3_length(gradient);
    for (int k = 0; k < 3; k++)
        gradient[k] = length > 0 ? gradient[k] / length : k == 1;
    return length - radius;
}

/* Distance to the round cone without flattening. */
static double cone_value(const implicit_part *part, const double p[3], double gradient[3],
                         double *radius) {
    double from_a[3], across[3];
    vec3_subtract(p, part->a, from_a);
    double along = vec3_dot(from_a, part->axis);
    vec3_along(from_a, -along, part->axis, across);
    double away = vec3_length(across);
    double tangent = along * part->cosine - away * part->sine; /* along the slanted side */
    if (tangent <= 0 || part->length == 0) {
        *radius = part->ra;
        return ball_value(p, part->a, part->ra, gradient);
    }
    if (tangent >= part->length * part->cosine) {
        *radius = part->rb;
        return ball_value(p, part->b, part->rb, gradient);
    }
    *radius = part->ra + (part->rb - part->ra) * tangent / (part->length * part->cosine);
    for (int k = 0; k < 3; k++)
        gradient[k] = part->sine * part->axis[k] + (away > 0 ? part->cosine * across[k] / away : 0);
    return away * part->cosine + along * part->sine - part->ra;
}

double implicit_part_value(const implicit_part *part, const double p[3], double gradient[3],
                           double *radius) {
    double own[3];
    if (gradient == NULL)
        gradient = own;
    if (part->flatten == 1)
        return cone_value(part, p, gradient, radius);
    /* stretch space, then shrink the value so that its Lipschitz constant stays 1 */
    double from_a[3], q[3], stretch = part->flatten - 1;
    vec3_subtract(p, part->a, from_a);
    vec3_along(p, stretch * vec3_dot(from_a, part->flat), part->flat, q);
    double value = cone_value(part, q, gradient, radius) / part->flatten;
    vec3_along(gradient, stretch * vec3_dot(gradient, part->flat), part->flat, gradient);
    for (int k = 0; k < 3; k++)
        gradient[k] /= part->flatten;
    *radius /= part->flatten;
    return value;
}

/* Joins one more part to the sample. */
static void join(implicit_sample *s, double value, const double gradient[3], double radius,
                 double blend) {
    double overlap = fmax(0, blend - fabs(value - s->value)) / blend;
    bool nearer = value < s->value;
    double share = nearer ? 1 - 0.5 * overlap : 0.5 * overlap; /* of the new part */
    s->value = fmin(value, s->value) - 0.25 * overlap * overlap * blend;
    for (int k = 0; k < 3; k++)
        s->gradient[k] += share * (gradient[k] - s->gradient[k]);
    s->radius += share * (radius - s->radius);
}

implicit_sample implicit_evaluate(const implicit_field *field, const double p[3]) {
    implicit_sample s = {.value = INFINITY};
    for (size_t i = 0; i < field->count; i++) {
        const implicit_part *part = &field->parts[i];
        double gradient[3], radius;
        if (isinf(s.value)) {
            s.value = implicit_part_value(part, p, s.gradient, &s.radius);
            continue;
        }
        /* the part's value is at least (distance to its ball) / flatten */
        double limit = (s.value + part->blend) * part->flatten + part->reach;
        if (limit <= 0 || vec3_distance_squared(p, part->center) >= limit * limit)
            continue;
        double value = implicit_part_value(part, p, gradient, &radius);
        join(&s, value, gradient, radius, part->blend);
    }
    return s;
}

void implicit_project(const implicit_field *field, double p[3], int steps, double gradient[3]) {
    for (int i = 0; i < steps; i++) {
        implicit_sample s = implicit_evaluate(field, p);
        vec3_copy(s.gradient, gradient);
        double square = vec3_dot(s.gradient, s.gradient);
        if (square < 1e-4) /* on the solid's medial axis: the gradient vanishes */
            return;
        vec3_along(p, -s.value / square, s.gradient, p);
    }
}

void implicit_bounds(const implicit_field *field, double lower[3], double upper[3]) {
    for (int k = 0; k < 3; k++) {
        lower[k] = INFINITY;
        upper[k] = -INFINITY;
    }
    for (size_t i = 0; i < field->count; i++) {
        const implicit_part *part = &field->parts[i];
        double margin = 0.5 * part->blend; /* the union bulges by at most a quarter of the blend */
        for (int k = 0; k < 3; k++) {
            lower[k] = fmin(lower[k], fmin(part->a[k] - part->ra, part->b[k] - part->rb) - margin);
            upper[k] = fmax(upper[k], fmax(part->a[k] + part->ra, part->b[k] + part->rb) + margin);
        }
    }
}
