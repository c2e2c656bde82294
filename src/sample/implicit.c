/* SPDX-License-Identifier: Apache-2.0 */
/* Round cones, revolved and extruded outlines, and their smooth union.
 *
 * The distance to a round cone is computed in the half-plane through its axis: there the outline is
 * two arcs joined by their common tangent. Parts are joined one by one by the quadratic smooth
 * minimum, which differs from the minimum only where the two values are closer than the blend; so
 * skipping a distant part does not change the value by a bit. All have Lipschitz constant 1, which
 * lets the mesher skip empty space. A carved part is the same union of its inside with the outside
 * of the rest. */
#include "sample/solids.h"

#include "geometry/vec3.h"

/* The ball about the axis' middle that contains the grown outline. */
static double outline_reach(const implicit_part *part) {
    const implicit_outline *o = part->outline;
    double most = 0;
    for (size_t i = 0; i < o->count; i++) {
        double x = o->points[i][0], y = o->points[i][1], half = 0.5 * part->length;
        most = fmax(most, o->extruded ? hypot(hypot(x, y), half) : hypot(x, y - half));
    }
    return most + part->ra;
}

void implicit_prepare(implicit_part *part) {
    if (part->flatten < 1)
        part->flatten = 1;
    vec3_subtract(part->b, part->a, part->axis);
    part->length = vec3_length(part->axis);
    for (int k = 0; k < 3; k++) {
        part->axis[k] = part->length > 0 ? part->axis[k] / part->length : k == 0;
        part->center[k] = 0.5 * (part->a[k] + part->b[k]);
    }
    part->reach =
        part->outline != NULL ? outline_reach(part) : 0.5 * part->length + fmax(part->ra, part->rb);
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

/* Signed distance of q to the polygon, and its gradient. */
static double polygon_value(const implicit_outline *o, const double q[2], double gradient[2]) {
    double nearest = INFINITY, away[2] = {0, 0};
    bool inside = false;
    for (size_t i = 0, j = o->count - 1; i < o->count; j = i++) {
        const double *a = o->points[j], *b = o->points[i];
        double e[2] = {b[0] - a[0], b[1] - a[1]}, w[2] = {q[0] - a[0], q[1] - a[1]};
        double square = e[0] * e[0] + e[1] * e[1];
        double t = square > 0 ? fmax(0, fmin(1, (w[0] * e[0] + w[1] * e[1]) / square)) : 0;
        double d[2] = {w[0] - t * e[0], w[1] - t * e[1]}, length = hypot(d[0], d[1]);
        if (length < nearest) {
            nearest = length;
            away[0] = d[0];
            away[1] = d[1];
        }
        if ((a[1] > q[1]) != (b[1] > q[1]) && q[0] < a[0] + e[0] * (q[1] - a[1]) / e[1])
            inside = !inside;
    }
    for (int k = 0; k < 2; k++)
        gradient[k] = nearest > 0 ? (inside ? -away[k] : away[k]) / nearest : 0;
    return inside ? -nearest : nearest;
}

/* Distance to the extruded outline, from that in its plane and that from its ends. */
static double extruded_value(double plane, double ends, double share[2]) {
    double x = fmax(plane, 0), y = fmax(ends, 0), outside = hypot(x, y);
    if (outside > 0) {
        share[0] = x / outside;
        share[1] = y / outside;
        return outside;
    }
    share[0] = plane > ends;
    share[1] = !(plane > ends);
    return fmax(plane, ends);
}

static double outline_value(const implicit_part *part, const double p[3], double gradient[3]) {
    double from_a[3], u[3], v[3], q[2], slope[2], share[2] = {1, 0};
    const implicit_outline *o = part->outline;
    vec3_subtract(p, part->a, from_a);
    double along = vec3_dot(from_a, part->axis), value;
    if (!o->extruded) {
        vec3_along(from_a, -along, part->axis, u);
        q[0] = vec3_length(u);
        q[1] = along;
        for (int k = 0; k < 3; k++)
            u[k] = q[0] > 0 ? u[k] / q[0] : 0;
        vec3_copy(part->axis, v);
        value = polygon_value(o, q, slope);
    } else {
        vec3_copy(part->flat, u);
        vec3_cross(part->axis, u, v);
        q[0] = vec3_dot(from_a, u);
        q[1] = vec3_dot(from_a, v);
        double half = 0.5 * part->length;
        value = extruded_value(polygon_value(o, q, slope), fabs(along - half) - half, share);
        share[1] *= along < half ? -1 : 1;
    }
    for (int k = 0; k < 3; k++)
        gradient[k] = share[0] * (slope[0] * u[k] + slope[1] * v[k]) + share[1] * part->axis[k];
    return value - part->ra;
}

double implicit_part_value(const implicit_part *part, const double p[3], double gradient[3],
                           double *radius) {
    double own[3];
    if (gradient == NULL)
        gradient = own;
    if (part->outline != NULL) {
        *radius = part->rb;
        return outline_value(part, p, gradient);
    }
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

/* Swaps inside and outside. */
static void invert(implicit_sample *s) {
    s->value = -s->value;
    for (int k = 0; k < 3; k++)
        s->gradient[k] = -s->gradient[k];
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
        double before = part->carve ? -s.value : s.value;
        double limit = (before + part->blend) * part->flatten + part->reach;
        if (limit <= 0 || vec3_distance_squared(p, part->center) >= limit * limit)
            continue;
        double value = implicit_part_value(part, p, gradient, &radius);
        if (part->carve)
            invert(&s);
        join(&s, value, gradient, radius, part->blend);
        if (part->carve)
            invert(&s);
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
            if (part->outline != NULL) {
                lower[k] = fmin(lower[k], part->center[k] - part->reach - margin);
                upper[k] = fmax(upper[k], part->center[k] + part->reach + margin);
                continue;
            }
            lower[k] = fmin(lower[k], fmin(part->a[k] - part->ra, part->b[k] - part->rb) - margin);
            upper[k] = fmax(upper[k], fmax(part->a[k] + part->ra, part->b[k] + part->rb) + margin);
        }
    }
}
