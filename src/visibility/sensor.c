/* SPDX-License-Identifier: Apache-2.0 */
#include "visibility/sensor.h"

#include <math.h>

#include "core/fields.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

static const double HALF_DEGREE = 3.14159265358979323846 / 360;

/* ---- definitions that a verifier shares ---- */

double starg_cone_cosine(double degrees) {
    if (degrees == 180)
        return 0;
    return degrees >= 360 ? -1 : cos(degrees * HALF_DEGREE);
}

static void normalize(double v[3]) {
    double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    for (int k = 0; k < 3 && most > 0; k++)
        v[k] /= most; /* squares neither overflow nor vanish */
    double length = vec3_length(v);
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
}

double starg_incidence_cosine(double degrees) {
    return degrees > 0 && degrees < 90 ? cos(degrees * (2 * HALF_DEGREE)) : 0;
}

void sensor_frame(const double direction[3], const double up[3], double frame[3][3]) {
    double *right = frame[0], *above = frame[1], *ahead = frame[2];
    vec3_copy(direction, ahead);
    vec3_copy(up, above);
    normalize(ahead);
    normalize(above);
    vec3_cross(ahead, above, right);
    for (int k = 0; k < 3 && !(vec3_length(right) > 1e-9); k++) {
        for (int i = 0; i < 3; i++)
            above[i] = i == (k + 1) % 3;
        vec3_cross(ahead, above, right);
    }
    normalize(right);
    vec3_cross(right, ahead, above);
}

double starg_density_depth(const starg_visibility_options *options, double density) {
    static const double per_metre[] = {12.5, 25, 62.5, 125, 250};
    static const double metres[] = {1, 0.01, 0.001, 0.3048, 0.0254};
    density = density != 0 ? density : options->density;
    if (!(options->resolution[0] > 0 && options->fov[0] > 0) || density == 0)
        return INFINITY;
    if (density < 0) {
        size_t name = (size_t)(-density - 1);
        if (name >= sizeof per_metre / sizeof *per_metre || (size_t)options->unit > STARG_UNIT_INCH)
            return 0;
        density = per_metre[name] * metres[options->unit];
    }
    return options->resolution[0] / (2 * tan(options->fov[0] * HALF_DEGREE)) / density;
}

void starg_depth_plane(const double point[3], const double direction[3], double depth, double at[3],
                       double normal[3]) {
    double ahead[3];
    vec3_copy(direction, ahead);
    normalize(ahead);
    vec3_along(point, depth, ahead, at);
    for (int k = 0; k < 3; k++)
        normal[k] = -ahead[k];
}

bool starg_tilt_holds(const starg_visibility_options *options, const double direction[3]) {
    static const double Y[3] = {0, 1, 0}, SLACK = 1e-6;
    const double *u = options->up;
    double up[3], ahead[3];
    if (options->tilt[0] == STARG_TILT_ANY)
        return true;
    vec3_copy(u[0] == 0 && u[1] == 0 && u[2] == 0 ? Y : u, up);
    vec3_copy(direction, ahead);
    normalize(up);
    normalize(ahead);
    double across[3];
    vec3_cross(up, ahead, across);
    double angle = atan2(vec3_dot(up, ahead), vec3_length(across)) / (2 * HALF_DEGREE);
    return angle >= options->tilt[0] - SLACK && angle <= options->tilt[1] + SLACK;
}

void starg_frustum(const double direction[3], const double up[3], const double fov[2],
                   double planes[4][3]) {
    double frame[3][3];
    sensor_frame(direction, up, frame);
    for (int side = 0; side < 4; side++) {
        double half = fov[side / 2] * HALF_DEGREE, sign = side % 2 == 0 ? 1 : -1;
        for (int k = 0; k < 3; k++)
            planes[side][k] = sin(half) * frame[2][k] + sign * cos(half) * frame[side / 2][k];
    }
}

void sensor_tilt(const starg_visibility_options *o, double direction[3]) {
    static const double Y[3] = {0, 1, 0}, LEAST = 1e-9;
    double up[3], flat[3], ahead[3];
    if (o->tilt[0] == STARG_TILT_ANY)
        return;
    vec3_copy(o->up[0] == 0 && o->up[1] == 0 && o->up[2] == 0 ? Y : o->up, up);
    vec3_copy(direction, ahead);
    normalize(up);
    normalize(ahead);
    double sine = vec3_dot(up, ahead);
    vec3_along(ahead, -sine, up, flat);
    double cosine = vec3_length(flat), angle = atan2(sine, cosine) / (2 * HALF_DEGREE);
    double wanted = fmin(fmax(angle, o->tilt[0]), o->tilt[1]) * (2 * HALF_DEGREE);
    if (angle >= o->tilt[0] && angle <= o->tilt[1])
        return;
    if (cosine < LEAST) { /* straight up or down: towards an axis that is not */
        int axis = fabs(up[2]) < 0.9 ? 2 : 0;
        const double other[3] = {axis == 0, 0, axis == 2};
        vec3_along(other, -vec3_dot(up, other), up, flat);
    }
    normalize(flat);
    for (int k = 0; k < 3; k++)
        direction[k] = cos(wanted) * flat[k] + sin(wanted) * up[k];
}

/* ---- the sensor ---- */

sensor sensor_of(const starg_visibility_options *options) {
    sensor own;
    own.options = options;
    own.reaches = options->range < 1e100 || options->near > 0;
    own.conical = options->cone < 360;
    own.rectangular = options->fov[0] > 0;
    own.cosine = own.conical ? starg_cone_cosine(options->cone) : -1;
    own.steepest = starg_incidence_cosine(options->incidence);
    own.direction = NULL;
    own.depth = starg_density_depth(options, 0);
    return own;
}

static bool is_zero(const double v[3]) {
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

void sensor_aim(sensor *own, const double direction[3], const double up[3]) {
    static const double Y[3] = {0, 1, 0};
    own->direction = direction;
    if (!own->rectangular)
        return;
    if (up == NULL || is_zero(up))
        up = own->options->up;
    starg_frustum(direction, is_zero(up) ? Y : up, own->options->fov, own->planes);
}

bool sensor_is_near(const sensor *own, const double p[3], double depth, const double q[3]) {
    double at[3], normal[3];
    if (!(depth < 1e100))
        return true;
    starg_depth_plane(p, own->direction, depth, at, normal);
    return compare_plane(at, normal, q) >= 0;
}

bool sensor_reaches(const sensor *own, const double p[3], const double q[3]) {
    const starg_visibility_options *o = own->options;
    return !own->reaches || ((o->range >= 1e100 || compare_distance(p, q, o->range) <= 0) &&
                             (o->near <= 0 || compare_distance(p, q, o->near) >= 0));
}

bool sensor_frames(const sensor *own, const double p[3], const double q[3]) {
    if (own->conical && compare_cone(p, own->direction, own->cosine, q) < 0)
        return false;
    for (int side = 0; own->rectangular && side < 4; side++)
        if (compare_plane(p, own->planes[side], q) < 0)
            return false;
    return !own->rectangular || sensor_is_near(own, p, own->depth, q);
}

bool sensor_faces(const sensor *own, const double p[3], const double *const face[3],
                  const double q[3]) {
    return own->steepest == 0 ||
           compare_incidence(face[0], face[1], face[2], p, q, own->steepest) >= 0;
}

/* ---- arguments ---- */

static bool is_finite(const double v[3]) {
    return fabs(v[0]) < 1e100 && fabs(v[1]) < 1e100 && fabs(v[2]) < 1e100;
}

static starg_status check_directions(starg_context *context, const char *stage, size_t count,
                                     const starg_visibility_options *o) {
    if (o->directions == NULL && count > 0)
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "a %s needs a direction for each point",
                          o->cone < 360 ? "cone" : "field of view");
    for (size_t i = 0; i < count; i++) {
        const double *d = o->directions + 3 * i, *up = o->ups != NULL ? o->ups + 3 * i : NULL;
        uint64_t point = i;
        if (!is_finite(d) || is_zero(d))
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, stage, STARG_ELEMENT_CANDIDATE,
                                 &point, 1,
                                 "the direction of point %zu is (%g, %g, %g); it must be finite "
                                 "and not zero",
                                 i, d[0], d[1], d[2]);
        if (up != NULL && !is_finite(up))
            return starg_fail_at(context, STARG_ERROR_ARGUMENT, stage, STARG_ELEMENT_CANDIDATE,
                                 &point, 1, "what is up for point %zu is not finite", i);
    }
    return STARG_OK;
}

/* Limits of directed views that exclude each other, or lack what they need. */
static starg_status check_camera(starg_context *context, const char *stage,
                                 const starg_visibility_options *o) {
    bool resolved = o->resolution[0] > 0 || o->resolution[1] > 0;
    if (resolved && !(o->resolution[0] > 0 && o->resolution[1] > 0 && o->resolution[0] < 1e7 &&
                      o->resolution[1] < 1e7))
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "the resolution is %g by %g pixels; both must be above 0",
                          o->resolution[0], o->resolution[1]);
    if (resolved && !(o->fov[0] > 0))
        return starg_fail(
            context, STARG_ERROR_ARGUMENT, stage,
            "a resolution is that of a rectangular view; give its field of view (fov)");
    if (o->density != 0 && !resolved)
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "a density of pixels needs to know how many there are: give the "
                          "resolution, and the field of view (fov)");
    if (o->tilt[0] == STARG_TILT_ANY && o->tilt[1] == STARG_TILT_ANY)
        return STARG_OK;
    if (!(o->tilt[0] >= -90 && o->tilt[1] <= 90 && o->tilt[0] <= o->tilt[1]))
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "the tilt is from %g to %g degrees; give the least and then the most, "
                          "from -90 (straight down) to 90",
                          o->tilt[0], o->tilt[1]);
    return STARG_OK;
}

starg_status sensor_check(starg_context *context, const char *stage, size_t count,
                          const starg_visibility_options *o) {
    if (o->face_rule == STARG_FACES_WHOLE && o->cone < 360 && o->cone > 180)
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "the cone is %g degrees; whole faces need one of at most 180, or of 360",
                          o->cone);
    if ((o->fov[0] > 0) != (o->fov[1] > 0) || !(o->fov[0] >= 0 && o->fov[0] < 180) ||
        !(o->fov[1] >= 0 && o->fov[1] < 180))
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "the field of view is %g by %g degrees; both must be above 0 and below "
                          "180; for wider views use a cone",
                          o->fov[0], o->fov[1]);
    if (o->fov[0] > 0 && o->cone < 360)
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "a cone and a field of view exclude each other");
    starg_status camera = check_camera(context, stage, o);
    if (camera != STARG_OK)
        return camera;
    if (!is_finite(o->up))
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage, "what is up is not finite");
    if (!(o->near < o->range))
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "nothing is at least %g and at most %g away; the near distance must be "
                          "below the range",
                          o->near, o->range);
    if (o->incidence > 0 && o->target != STARG_TARGET_FACES)
        return starg_fail(context, STARG_ERROR_ARGUMENT, stage,
                          "vertices are seen from any side: a limited incidence is for faces");
    return sensor_is_directed(o) ? check_directions(context, stage, count, o) : STARG_OK;
}
