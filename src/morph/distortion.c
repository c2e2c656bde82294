/* SPDX-License-Identifier: Apache-2.0 */
/* Distortion of a composed map at a vertex.
 *
 * Energy of a triangle of area S: S (s^2 + r^2 + 1/s^2 + 1/r^2) for the singular values s, r of the
 * linear map to the flat triangle of its corners' images (symmetric Dirichlet), both surfaces
 * scaled to equal area; plus a small share of the roundness of its spherical triangle, squared
 * edges over area, which is infinite where that flips: it keeps room for moves. */

#include "geometry/vec3.h"
#include "morph/surface_map.h"

static const double ROUND = 0.05; /* weight of roundness */

/* ---- places ---- */

static void scaled_place(const composition *c, const surface_point *point, double out[3]) {
    surface_place(c->to->sphere->mesh, point, out);
    for (int k = 0; k < 3; k++)
        out[k] *= c->scale;
}

void composition_locate(composition *c, uint32_t v, uint32_t start) {
    surface_point *p = &c->points[v];
    p->face = locate(c->to, c->from->directions + 3 * (size_t)v, start, p->coordinates);
    scaled_place(c, p, c->images + 3 * (size_t)v);
}

void composition_locate_all(composition *c) {
    uint32_t face = 0;
    for (size_t i = 0; i < c->from->rings->left; i++) {
        composition_locate(c, c->from->alive[i], face);
        face = c->points[c->from->alive[i]].face;
    }
}

double composition_nearest(const composition *c, uint32_t v) {
    const ring *around = &c->from->rings->of[v];
    double least = INFINITY;
    for (size_t i = 0; i < around->count; i++)
        least = fmin(least, vec3_distance(c->images + 3 * (size_t)v,
                                          c->images + 3 * (size_t)around->data[i]));
    return least;
}

void trial_here(const composition *c, uint32_t v, trial *t) {
    t->point = c->points[v];
    vec3_copy(c->images + 3 * (size_t)v, t->image);
    vec3_copy(c->from->directions + 3 * (size_t)v, t->direction);
}

void trial_at(const composition *c, const surface_point *point, trial *t) {
    const sphere *s = c->to->sphere;
    double sum[3] = {0};
    t->point = *point;
    scaled_place(c, point, t->image);
    for (size_t k = 0; k < 3; k++)
        vec3_along(sum, point->coordinates[k],
                   s->directions + 3 * (size_t)s->mesh->faces[3 * (size_t)point->face + k], sum);
    double length = vec3_length(sum);
    for (int k = 0; k < 3; k++)
        t->direction[k] = sum[k] / length;
}

bool trial_is_valid(const composition *c, uint32_t v, const trial *t) {
    return relax_is_positive(&c->from->rings->of[v], c->from->directions, t->direction);
}

void trial_accept(composition *c, uint32_t v, const trial *t) {
    vec3_copy(t->direction, c->from->directions + 3 * (size_t)v);
    vec3_copy(t->image, c->images + 3 * (size_t)v);
    c->points[v] = t->point;
}

/* ---- energy ---- */

triangle_form triangle_form_of(const double apex[3], const double p[3], const double q[3],
                               double floor) {
    triangle_form out;
    vec3_subtract(p, apex, out.u);
    vec3_subtract(q, apex, out.w);
    out.e = vec3_dot(out.u, out.u) + floor;
    out.f = vec3_dot(out.u, out.w) + 0.5 * floor;
    out.g = vec3_dot(out.w, out.w) + floor;
    out.area = out.e * out.g - out.f * out.f;
    return out;
}

/* Roundness of the spherical triangle v p q: at least 1, the value of an equilateral one, by flat
 * measures; infinite if it flips. Adds the weighted gradient unless that is NULL. */
static double roundness(const composition *c, const uint32_t corner[3], const double direction[3],
                        double weight, double *gradient) {
    const double *p = c->from->directions + 3 * (size_t)corner[1];
    const double *q = c->from->directions + 3 * (size_t)corner[2];
    const double factor = 1 / sqrt(12);
    double n[3], u[3], w[3];
    vec3_cross(p, q, n);
    vec3_subtract(direction, p, u);
    vec3_subtract(direction, q, w);
    double volume = vec3_dot(direction, n);
    double edges = vec3_dot(u, u) + vec3_dot(w, w) + vec3_distance_squared(p, q);
    if (!(volume > 0))
        return INFINITY;
    for (int k = 0; gradient != NULL && k < 3; k++)
        gradient[k] += weight * factor * (2 * (u[k] + w[k]) - edges * n[k] / volume) / volume;
    return factor * edges / volume;
}

/* Symmetric Dirichlet energy of the triangle v p q with the image of v at x; adds the gradient
 * unless that is NULL. `weight` receives twice the area. */
static double stretch(const composition *c, const uint32_t corner[3], const double x[3],
                      double *weight, double *gradient) {
    const double *surface = c->from->mesh->vertices;
    const triangle_form a =
        triangle_form_of(surface + 3 * (size_t)corner[0], surface + 3 * (size_t)corner[1],
                         surface + 3 * (size_t)corner[2], c->floor);
    const triangle_form b = triangle_form_of(x, c->images + 3 * (size_t)corner[1],
                                             c->images + 3 * (size_t)corner[2], c->floor);
    *weight = a.area > 0 ? sqrt(a.area) : 0;
    if (!(a.area > 0 && b.area > 0))
        return a.area > 0 ? INFINITY : 0;
    double trace = (a.g * b.e - 2 * a.f * b.f + a.e * b.g) / a.area;
    double back = 1 + a.area / b.area;
    for (int k = 0; gradient != NULL && k < 3; k++) {
        double sum = b.u[k] + b.w[k];
        double trace_slope = -2 * (a.g * b.u[k] - a.f * sum + a.e * b.w[k]) / a.area;
        double area_slope = -2 * (b.g * b.u[k] - b.f * sum + b.e * b.w[k]);
        gradient[k] +=
            *weight * (trace_slope * back - trace * a.area / (b.area * b.area) * area_slope);
    }
    return *weight * trace * back;
}

void trial_measure(const composition *c, uint32_t v, bool with_slopes, trial *t) {
    const ring *around = &c->from->rings->of[v];
    double *slope = with_slopes ? t->slope : NULL;
    double *spherical_slope = with_slopes ? t->spherical_slope : NULL;
    t->energy = 0;
    memset(t->slope, 0, sizeof t->slope);
    memset(t->spherical_slope, 0, sizeof t->spherical_slope);
    for (size_t i = 0; i < around->count && t->energy < INFINITY; i++) {
        const uint32_t corner[3] = {v, around->data[i], around->data[(i + 1) % around->count]};
        double weight;
        t->energy += stretch(c, corner, t->image, &weight, slope);
        weight *= ROUND;
        t->energy += weight * roundness(c, corner, t->direction, weight, spherical_slope);
    }
}

double trial_roundness(const composition *c, uint32_t v, const trial *t) {
    const ring *around = &c->from->rings->of[v];
    double most = 0;
    for (size_t i = 0; i < around->count; i++) {
        const uint32_t corner[3] = {v, around->data[i], around->data[(i + 1) % around->count]};
        most = fmax(most, roundness(c, corner, t->direction, 1, NULL));
    }
    return most;
}

double composition_energy(const composition *c) {
    const sphere *s = c->from;
    double sum = 0;
    for (size_t i = 0; i < s->rings->left; i++) {
        trial t;
        trial_here(c, s->alive[i], &t);
        trial_measure(c, s->alive[i], false, &t);
        sum += t.energy / 3;
    }
    return sum;
}
