/* SPDX-License-Identifier: Apache-2.0 */
/* What a sensor limits, apart from what stands in its way: all rules of the verifier. All exact for
 * finite doubles below 1e100. */
#ifndef STARG_VERIFY_SENSOR_H
#define STARG_VERIFY_SENSOR_H

#include <stdbool.h>

#include "starguard/visibility.h"

/* The limits of a view. */
typedef struct verify_view {
    double range, near; /* vertices farther away, or nearer, count as not seen */
    starg_face_rule rule;
    const double *direction; /* of a cone of view, or NULL */
    double cosine;           /* of half the cone's opening */
    bool framed;             /* by planes of a rectangular view */
    double planes[4][3];
    double steepest; /* cosine of the incidence; 0: any */
} verify_view;

/* Is the angle at p between `direction` (not zero) and q at most that of the cosine? q = p counts
 * as within. */
bool verify_in_cone(const double p[3], const double direction[3], double cosine, const double q[3]);

/* Is q at a distance, and in a direction, in which the view from p holds vertices? */
bool verify_in_view(const verify_view *view, const double p[3], const double q[3]);

/* Is the triangle t seen from p, strictly on its inner side, at an incidence that the view allows?
 */
bool verify_faces(const verify_view *view, const double p[3], const double *const t[3]);

/* Are p and q, as seen from the centroid of the triangle, at least as far apart as the angle of
 * this cosine? */
bool verify_apart(const double *const t[3], const double p[3], const double q[3], double cosine);

#endif
