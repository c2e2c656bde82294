/* SPDX-License-Identifier: Apache-2.0 */
/* Sensors: which vertices and faces count as seen, of those to which the view is free.
 *
 * All limits stand here: distances, a cone or a rectangular view about a direction, incidence. Each
 * is an exact sign. Limits of a vertex hold for all corners of a face; all of them but the smallest
 * distance then hold for every point of it (with a cone of at most 180 degrees, or of 360), since
 * balls, such cones and frusta are convex, and so is the disc of a plane that is seen at a limited
 * incidence. */
#ifndef STARG_VISIBILITY_SENSOR_H
#define STARG_VISIBILITY_SENSOR_H

#include "core/context.h"
#include "starguard/visibility.h"

/* A sensor, aimed in one direction where it looks in one. */
typedef struct sensor {
    const starg_visibility_options *options;
    bool reaches; /* distances are limited */
    bool conical, rectangular;
    double cosine;   /* of half the cone */
    double steepest; /* cosine of the incidence; 0: any */
    const double *direction;
    double planes[4][3];
    double depth; /* largest, by the density; INFINITY: any */
} sensor;

/* Do guards look in one direction each? */
static inline bool sensor_is_directed(const starg_visibility_options *o) {
    return o->cone < 360 || o->fov[0] > 0;
}

/* The same in all directions. */
static inline starg_visibility_options sensor_around(const starg_visibility_options *o) {
    starg_visibility_options out = *o;
    out.cone = 360;
    out.fov[0] = out.fov[1] = 0;
    return out;
}

/* The sensor of some options, which must outlive it; not aimed. */
sensor sensor_of(const starg_visibility_options *options);

/* Right, above and ahead of a direction, of unit length; see starg_frustum. */
void sensor_frame(const double direction[3], const double up[3], double frame[3][3]);

/* Aims it, if it looks in one direction; `up` may be NULL. */
void sensor_aim(sensor *own, const double direction[3], const double up[3]);

/* Turns a direction, not zero, to the nearest within the tilt; of unit length if it turns. */
void sensor_tilt(const starg_visibility_options *options, double direction[3]);

/* Is q at a distance from p that it sees? */
bool sensor_reaches(const sensor *own, const double p[3], const double q[3]);

/* Is q, from p, at most so deep in the view? */
bool sensor_is_near(const sensor *own, const double p[3], double depth, const double q[3]);

/* Is q in the view of the sensor, aimed from p? */
bool sensor_frames(const sensor *own, const double p[3], const double q[3]);

/* Is a point q of the plane of a face, p being on its inner side, not seen too obliquely? */
bool sensor_faces(const sensor *own, const double p[3], const double *const face[3],
                  const double q[3]);

/* Errors: ARGUMENT (limits that exclude each other, directions that are none). */
starg_status sensor_check(starg_context *context, const char *stage, size_t count,
                          const starg_visibility_options *options);

#endif
