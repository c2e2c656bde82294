/* SPDX-License-Identifier: Apache-2.0 */
/* Tubes of circular section around closed curves: the torus and a trefoil knot.
 *
 * The section uses the Frenet frame, which is periodic on both curves (their curvature never
 * vanishes), so rows close without twist. Rows are spaced by arc length; the number of points per
 * row follows from the ratio of the tube's girth to its length. */

#include "geometry/vec3.h"
#include "sample/solids.h"

static const double TURN = 6.28318530717958648;

enum { LENGTH_STEPS = 4096, MIN_ROUND = 5 };

/* Point, first and second derivative at t in [0, TURN). */
typedef void curve(double t, double point[3], double first[3], double second[3]);

static void circle(double t, double point[3], double first[3], double second[3]) {
    double p[3] = {cos(t), 0, -sin(t)}, d[3] = {-sin(t), 0, -cos(t)};
    vec3_copy(p, point);
    vec3_copy(d, first);
    for (int k = 0; k < 3; k++)
        second[k] = -p[k];
}

/* (sin t + 2 sin 2t, sin 3t, cos t - 2 cos 2t) */
static void trefoil(double t, double point[3], double first[3], double second[3]) {
    double p[3] = {sin(t) + 2 * sin(2 * t), 1.15 * sin(3 * t), cos(t) - 2 * cos(2 * t)};
    double d[3] = {cos(t) + 4 * cos(2 * t), 3.45 * cos(3 * t), -sin(t) + 4 * sin(2 * t)};
    double e[3] = {-sin(t) - 8 * sin(2 * t), -10.35 * sin(3 * t), -cos(t) + 8 * cos(2 * t)};
    vec3_copy(p, point);
    vec3_copy(d, first);
    vec3_copy(e, second);
}

static void normalize(double v[3]) {
    double length = vec3_length(v);
    for (int k = 0; k < 3; k++)
        v[k] /= length;
}

/* Arc length from 0 to i steps, by the midpoint rule. */
static void measure(curve *c, double *lengths) {
    lengths[0] = 0;
    for (int i = 0; i < LENGTH_STEPS; i++) {
        double p[3], d[3], e[3];
        c(TURN * (i + 0.5) / LENGTH_STEPS, p, d, e);
        lengths[i + 1] = lengths[i] + vec3_length(d) * TURN / LENGTH_STEPS;
    }
}

static starg_status make_ring(mesh_builder *builder, curve *c, double t, double radius,
                              size_t around, size_t ring) {
    double point[3], tangent[3], normal[3], binormal[3];
    c(t, point, tangent, normal);
    vec3_cross(tangent, normal, binormal);
    vec3_cross(binormal, tangent, normal);
    normalize(normal);
    normalize(binormal);
    for (size_t j = 0; j < around; j++) {
        /* every other ring is rotated by half a step: better triangles, and no visible seam */
        double angle = TURN * ((double)j + 0.5 * (double)(ring % 2)) / (double)around, p[3];
        vec3_along(point, radius * cos(angle), normal, p);
        vec3_along(p, radius * sin(angle), binormal, p);
        uint32_t vertex;
        TRY(builder_vertex(builder, ring * around + j, p, &vertex));
    }
    return STARG_OK;
}

static starg_status make_strip(mesh_builder *builder, size_t ring, size_t rings, size_t around) {
    TRY(starg_check_cancel(builder->context, "sample"));
    uint32_t from = (uint32_t)(ring * around), to = (uint32_t)((ring + 1) % rings * around);
    for (uint32_t j = 0; j < around; j++) {
        uint32_t k = (j + 1) % (uint32_t)around;
        if (ring % 2 == 0) {
            TRY(builder_triangle(builder, from + j, from + k, to + j));
            TRY(builder_triangle(builder, from + k, to + k, to + j));
        } else {
            TRY(builder_triangle(builder, from + j, to + k, to + j));
            TRY(builder_triangle(builder, from + j, from + k, to + k));
        }
    }
    return STARG_OK;
}

static starg_status make_tube(starg_context *context, curve *c, double radius, size_t vertex_count,
                              starg_mesh **out) {
    SCOPED_BY(builder_free) mesh_builder builder = {.context = context};
    /* too large for a small stack */
    SCOPED double *lengths = NULL;
    NEW(context, "sample", lengths, LENGTH_STEPS + 1);
    measure(c, lengths);
    double length = lengths[LENGTH_STEPS], girth = TURN * radius;
    /* rows of equilateral triangles are 0.87 of their side apart */
    double around_exact = sqrt((double)vertex_count * 0.87 * girth / length);
    size_t around = (size_t)(around_exact + 0.5);
    if (around < MIN_ROUND)
        around = MIN_ROUND;
    size_t rings = 2 * (size_t)((double)vertex_count / (2.0 * (double)around) + 0.5);
    for (size_t i = 0, step = 0; i < rings; i++) {
        double wanted = length * (double)i / (double)rings;
        while (lengths[step + 1] <= wanted)
            step++;
        double part = (wanted - lengths[step]) / (lengths[step + 1] - lengths[step]);
        double t = TURN * ((double)step + part) / LENGTH_STEPS;
        TRY(make_ring(&builder, c, t, radius, around, i));
    }
    for (size_t i = 0; i < rings; i++)
        TRY(make_strip(&builder, i, rings, around));
    return builder_finish(&builder, out);
}

starg_status solid_torus(starg_context *context, size_t vertex_count, starg_mesh **out) {
    return make_tube(context, circle, 0.38, vertex_count, out);
}

starg_status solid_knot(starg_context *context, size_t vertex_count, starg_mesh **out) {
    return make_tube(context, trefoil, 0.52, vertex_count, out);
}
