/* SPDX-License-Identifier: Apache-2.0 */
/* Zones in which guards may stand, and zones in which they may not. */
#ifndef STARG_MESH_ZONES_H
#define STARG_MESH_ZONES_H

#include "geometry/bvh.h"
#include "starguard/space.h"

typedef struct zone {
    bool excludes;
    bvh_box box;            /* the zone, or that of its mesh */
    starg_solid *solid;     /* of the mesh; NULL: the box is the zone */
    size_t vertices, faces; /* of the mesh as given */
} zone;

typedef struct zones {
    size_t count;
    zone *list;
    bool limits; /* some of them do not exclude; then */
    bvh_box all; /* holds these */
} zones;

/* Errors: ARGUMENT (a box without an inside), MESH (a mesh that is not closed), MEMORY. */
starg_status zones_make(starg_context *context, const starg_zone *list, size_t count, zones *out);
void zones_free(zones *all);

/* May a guard stand at p, as far as they are concerned? */
bool zones_admit(const zones *all, const double p[3]);

/* Is it certain that none may stand in the box? */
bool zones_bar(const zones *all, const bvh_box *box);

#endif
