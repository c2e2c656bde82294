/* SPDX-License-Identifier: Apache-2.0 */
/* What one point sees, by a map of directions. */
#ifndef STARG_VERIFY_SIGHT_H
#define STARG_VERIFY_SIGHT_H

#include "starguard/visibility.h"
#include "verify/surface.h"

/* Working memory for points, one at a time; one thread. */
typedef struct verify_sight verify_sight;

starg_status verify_sight_create(const verify_surface *surface, verify_sight **out);
void verify_sight_free(verify_sight *sight);

/* Limits of a view. */
typedef struct verify_view {
    double range; /* vertices farther away count as not seen */
    starg_face_rule rule;
    const double *direction; /* axis of a viewing cone, or NULL: all around */
    double cosine;           /* of half the cone's opening angle */
} verify_view;

/* Computes what p, which must lie off the surface, sees. Vertices out of view and isolated vertices
 * count as not seen. On success `vertices` and `faces` point to a byte per element, 1 if seen,
 * valid until the next call. Errors: MEMORY (sets no detail: runs on any thread). */
starg_status verify_look(verify_sight *sight, const double p[3], const verify_view *view,
                         const uint8_t **vertices, const uint8_t **faces);

#endif
