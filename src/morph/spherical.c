/* SPDX-License-Identifier: Apache-2.0 */
/* Interpolated spherical coordinates about the guards [SR95 extended to 3D]: the baseline that
 * [YL11, section 5.2] reports as unsatisfactory.
 *
 * A corner of a face moves from its place relative to the face's guard in A to that relative to the
 * counterpart in B in radius, latitude and longitude, each linear in t, the longitude by the
 * shorter way; guards move straight. A vertex is the mean of its corners. */

#include "geometry/vec3.h"
#include "morph/morph.h"

static const char STAGE[] = "morph";
static const double PI = 3.14159265358979323846;

typedef struct polar {
    double radius, latitude, longitude;
} polar;

static polar polar_of(const double p[3], const double about[3]) {
    double d[3];
    vec3_subtract(p, about, d);
    double level = hypot(d[0], d[1]);
    return (polar){vec3_length(d), atan2(d[2], level), atan2(d[1], d[0])};
}

/* Adds the place of a corner at t. */
static void add_corner(const starg_morph *m, uint32_t guard, uint32_t v, double t, double *sum) {
    const double *g = m->places[0] + 3 * (size_t)guard, *h = m->places[1] + 3 * (size_t)guard;
    polar p = polar_of(m->mesh->vertices + 3 * (size_t)v, g);
    polar q = polar_of(m->images + 3 * (size_t)v, h);
    double turn = q.longitude - p.longitude;
    turn -= 2 * PI * round(turn / (2 * PI));
    double radius = p.radius + t * (q.radius - p.radius);
    double latitude = p.latitude + t * (q.latitude - p.latitude);
    double longitude = p.longitude + t * turn;
    const double d[3] = {radius * cos(latitude) * cos(longitude),
                         radius * cos(latitude) * sin(longitude), radius * sin(latitude)};
    for (int k = 0; k < 3; k++)
        sum[k] += (1 - t) * g[k] + t * h[k] + d[k];
}

starg_status morph_frame_spherical(const starg_morph *m, double t, double *out) {
    size_t count = m->mesh->vertex_count;
    SCOPED uint32_t *corners = NULL;
    NEW_ZERO(m->context, STAGE, corners, count);
    for (size_t i = 0; i < 3 * count; i++)
        out[i] = 0;
    for (size_t i = 0; i < 3 * m->mesh->face_count; i++) {
        uint32_t v = m->mesh->faces[i];
        add_corner(m, m->pieces[i / 3], v, t, out + 3 * (size_t)v);
        corners[v]++;
    }
    for (size_t v = 0; v < count; v++)
        for (size_t k = 0; k < 3; k++)
            out[3 * v + k] =
                corners[v] > 0 ? out[3 * v + k] / corners[v]
                               : (1 - t) * m->mesh->vertices[3 * v + k] + t * m->images[3 * v + k];
    return STARG_OK;
}
