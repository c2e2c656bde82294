/* SPDX-License-Identifier: Apache-2.0 */
/* Descent of a composed map, one vertex at a time.
 *
 * A vertex moves straight along the second surface against the gradient of its triangles' energy
 * (distortion.c), by the longest of some halved steps that lowers it. Steps are measured on the
 * surface, not on the sphere, so that they have one scale. Cost of a sweep: O(edges). */

#include "geometry/vec3.h"
#include "morph/surface_map.h"

static const char STAGE[] = "map";
enum { HALVINGS = 6 };
static const double FLOOR = 1e-3;     /* relative to the mean face area */
static const double FIRST_STEP = 0.5; /* relative to the distance of the nearest image */

/* The uphill direction in the face of a place, from both slopes; returns its length. */
static double uphill(const composition *c, const trial *t, double out[3]) {
    const sphere *s = c->to->sphere;
    const uint32_t *corner = s->mesh->faces + 3 * (size_t)t->point.face;
    double slopes[3], sum[3] = {0};
    for (size_t k = 0; k < 3; k++)
        vec3_along(sum, t->point.coordinates[k], s->directions + 3 * (size_t)corner[k], sum);
    double length = vec3_length(sum), along = vec3_dot(t->spherical_slope, t->direction);
    for (size_t k = 0; k < 3; k++) {
        const double *d = s->directions + 3 * (size_t)corner[k];
        slopes[k] = c->scale * vec3_dot(t->slope, s->mesh->vertices + 3 * (size_t)corner[k]) +
                    (vec3_dot(t->spherical_slope, d) - along * vec3_dot(t->direction, d)) / length;
    }
    return surface_gradient(s->mesh, &t->point, slopes, out) ? vec3_length(out) : 0;
}

static void descend(composition *c, uint32_t v) {
    trial now, next;
    double way[3];
    trial_here(c, v, &now);
    trial_measure(c, v, true, &now);
    double slope = uphill(c, &now, way), step = FIRST_STEP * composition_nearest(c, v) / c->scale;
    if (!(slope > 0 && slope < INFINITY))
        return;
    for (int i = 0; i < HALVINGS; i++, step *= 0.5) {
        surface_point point = now.point;
        const double d[3] = {-step / slope * way[0], -step / slope * way[1],
                             -step / slope * way[2]};
        surface_walk(c->to->sphere->mesh, c->to->topology, d, &point);
        trial_at(c, &point, &next);
        trial_measure(c, v, false, &next);
        if (next.energy < now.energy && trial_is_valid(c, v, &next)) {
            trial_accept(c, v, &next);
            return;
        }
    }
}

starg_status composition_descend(composition *c, int sweeps) {
    const sphere *s = c->from;
    c->floor = FLOOR * starg_mesh_area(s->mesh) / (double)s->rings->left;
    for (int i = 0; i < sweeps; i++) {
        TRY(starg_check_cancel(s->context, STAGE));
        for (size_t k = 0; k < s->rings->left; k++)
            if (!c->kept[s->alive[k]])
                descend(c, s->alive[k]);
    }
    return STARG_OK;
}
