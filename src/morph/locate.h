/* SPDX-License-Identifier: Apache-2.0 */
/* Point location on a spherical embedding. */
#pragma once

#include "mesh/topology.h"
#include "sphere/sphere.h"

typedef struct locator {
    const sphere *sphere; /* borrowed */
    mesh_topology *topology;
} locator;

/* Errors: MEMORY. */
starg_status locator_create(starg_context *context, const sphere *s, locator *out);
void locator_free(locator *l);

/* The face whose spherical triangle contains the direction, exactly (one of them on an edge), and
 * the barycentric coordinates of its central projection into the flat triangle. `start` is the face
 * to begin at. */
uint32_t locate(const locator *l, const double direction[3], uint32_t start, double coordinates[3]);
