/* SPDX-License-Identifier: Apache-2.0 */
/* What a place sees of a surface, and where guards may stand. */
#ifndef STARG_VERIFY_SIGHT_H
#define STARG_VERIFY_SIGHT_H

#include <stdbool.h>

#include "starguard/verify.h"
#include "starguard/visibility.h"
#include "verify/surface.h"

/* What a sensor limits, apart from what stands in its way: all rules of the verifier. All exact for
 * finite doubles below 1e100. */

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

/* What one point sees, by a map of directions. */

/* Working memory for points, one at a time; one thread. */
typedef struct verify_sight verify_sight;

starg_status verify_sight_create(const verify_surface *surface, verify_sight **out);
void verify_sight_free(verify_sight *sight);

/* Computes what p, which must lie off the surface, sees. Vertices out of view and isolated vertices
 * count as not seen. On success `vertices` and `faces` point to a byte per element, 1 if seen,
 * valid until the next call. Errors: MEMORY (sets no detail: runs on any thread). */
starg_status verify_look(verify_sight *sight, const double p[3], const verify_view *view,
                         const uint8_t **vertices, const uint8_t **faces);

/* The scene of a guards result as the verifier sees it. */

/* The surface of the model and of the obstacles of a result, which faces out of its free space; of
 * a plain solid verify_surface_create. `obstacles` has one mesh for each that the result names.
 * Errors: MESH, ARGUMENT (other obstacles than those of the result), MEMORY, CANCELLED. */
starg_status verify_space_create(starg_context *context, const starg_mesh *mesh,
                                 const starg_mesh *const *obstacles, size_t obstacle_count,
                                 const starg_guards *guards, verify_surface **out);

#endif
