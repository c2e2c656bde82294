/* SPDX-License-Identifier: Apache-2.0 */
/* Relaxation of spherical triangulations by stretch.
 *
 * Problem: a valid embedding in the sphere compresses limbs to almost nothing; give every part of
 * the surface its share of the sphere. Source: the stretch of a parameterization, minimized coarse
 * to fine by E. Praun, H. Hoppe, Spherical parametrization and remeshing, 2003.
 *
 * Energy of a triangle a b c on the sphere with the squared lengths l of the surface's edges and
 * their area S: S times the mean square stretch of the map from the sphere to the surface, which is
 * S sum of l_k cot(angle k) / D^2, with det(a, b, c) as D in place of twice the area, and the
 * cotangents over it as well. It is infinite where a triangle flips, also for the large ones of
 * coarse levels, and where its share of the sphere vanishes: descent avoids both. A small length is
 * added to all edges, so that needles keep some of their share.
 *
 * A vertex moves down the gradient in its tangent plane, by the longest of some halved steps that
 * lowers the energy of its triangles. Rounding never decides validity: the triangles at the new
 * place must pass the exact predicate. Cost: O(edges) a sweep. */
#include "sphere/sphere.h"

#include "geometry/predicates.h"
#include "geometry/vec3.h"

enum { HALVINGS = 8 };
static const double FIRST_STEP = 0.5; /* relative to the distance of the nearest neighbour */

static const double ORIGIN[3];

bool relax_is_positive(const ring *around, const double *directions, const double at[3]) {
    for (size_t i = 0; i < around->count; i++) {
        const double *p = directions + 3 * (size_t)around->data[i];
        const double *q = directions + 3 * (size_t)around->data[(i + 1) % around->count];
        if (orient3d(at, p, q, ORIGIN) != 1)
            return false;
    }
    return true;
}

/* A triangle at the moving vertex. */
typedef struct corner {
    const double *p, *q;
    double opposite, to_p, to_q; /* squared lengths of the surface's edges */
    double area;                 /* of the triangle with these edges, times 4 */
} corner;

static corner corner_of(const relaxation *r, uint32_t v, size_t i) {
    const ring *around = &r->rings->of[v];
    uint32_t p = around->data[i], q = around->data[(i + 1) % around->count];
    const double *surface = r->rings->positions, *own = surface + 3 * (size_t)v;
    const double *at_p = surface + 3 * (size_t)p, *at_q = surface + 3 * (size_t)q;
    double x = vec3_distance_squared(at_p, at_q) + r->floor;
    double y = vec3_distance_squared(own, at_p) + r->floor;
    double z = vec3_distance_squared(own, at_q) + r->floor;
    return (corner){.p = r->directions + 3 * (size_t)p,
                    .q = r->directions + 3 * (size_t)q,
                    .opposite = x,
                    .to_p = y,
                    .to_q = z,
                    .area = sqrt(fmax(0, 2 * (x * y + y * z + z * x) - x * x - y * y - z * z))};
}

/* Energy of one triangle with its vertex at x; adds the gradient unless that is NULL. */
static double corner_energy(const corner *c, const double x[3], double *gradient) {
    double n[3], xp[3], xq[3], pq[3];
    vec3_cross(c->p, c->q, n);
    vec3_subtract(c->p, x, xp);
    vec3_subtract(c->q, x, xq);
    vec3_subtract(c->q, c->p, pq);
    double volume = vec3_dot(x, n);
    if (!(volume > 0))
        return INFINITY;
    double sum =
        c->opposite * vec3_dot(xp, xq) - c->to_q * vec3_dot(xp, pq) + c->to_p * vec3_dot(xq, pq);
    for (int k = 0; gradient != NULL && k < 3; k++) {
        double slope = -c->opposite * (xp[k] + xq[k]) + (c->to_q - c->to_p) * pq[k];
        gradient[k] += c->area * (slope - 2 * sum * n[k] / volume) / (volume * volume);
    }
    return c->area * sum / (volume * volume);
}

static double energy_at(const relaxation *r, uint32_t v, const double x[3], double *gradient) {
    double sum = 0;
    for (size_t i = 0; i < r->rings->of[v].count; i++) {
        corner c = corner_of(r, v, i);
        sum += corner_energy(&c, x, gradient);
    }
    return sum;
}

static double nearest(const relaxation *r, uint32_t v) {
    const ring *around = &r->rings->of[v];
    double least = INFINITY;
    for (size_t i = 0; i < around->count; i++)
        least = fmin(least, vec3_distance(r->directions + 3 * (size_t)v,
                                          r->directions + 3 * (size_t)around->data[i]));
    return least;
}

static void relax_vertex(const relaxation *r, uint32_t v) {
    double *x = r->directions + 3 * (size_t)v, gradient[3] = {0};
    double before = energy_at(r, v, x, gradient);
    vec3_along(gradient, -vec3_dot(gradient, x), x, gradient);
    double slope = vec3_length(gradient), step = FIRST_STEP * nearest(r, v);
    if (!(slope > 0 && slope < INFINITY))
        return;
    for (int i = 0; i < HALVINGS; i++, step *= 0.5) {
        double y[3];
        vec3_along(x, -step / slope, gradient, y);
        double length = vec3_length(y);
        for (int k = 0; k < 3; k++)
            y[k] /= length;
        if (energy_at(r, v, y, NULL) < before &&
            relax_is_positive(&r->rings->of[v], r->directions, y)) {
            vec3_copy(y, x);
            return;
        }
    }
}

void relax_sweep(const relaxation *r) {
    for (size_t i = 0; i < r->alive_count; i++)
        if (r->pinned == NULL || r->pinned[r->alive[i]] == 0)
            relax_vertex(r, r->alive[i]);
}
