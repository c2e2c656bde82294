/* SPDX-License-Identifier: Apache-2.0 */
/* What one point sees, by a map of directions. */
#ifndef STARG_VERIFY_SIGHT_H
#define STARG_VERIFY_SIGHT_H

#include "verify/sensor.h"
#include "verify/surface.h"

/* Memory for looking around from points, one at a time; one thread. */
typedef struct verify_sight verify_sight;

starg_status verify_sight_create(const verify_surface *surface, verify_sight **out);
void verify_sight_free(verify_sight *sight);

/* Looks around from p, which must lie off the surface. Vertices out of the view and vertices of no
 * face count as not seen. On success `vertices` and `faces` point to a byte each: 1 is seen; they
 * are valid until the next call. Errors: MEMORY (no detail is set: runs on any thread). */
starg_status verify_look(verify_sight *sight, const double p[3], const verify_view *view,
                         const uint8_t **vertices, const uint8_t **faces);

#endif
