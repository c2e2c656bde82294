/* SPDX-License-Identifier: Apache-2.0 */
/* Which faces of a surface meet away from common corners, and where. */
#ifndef STARG_MESH_UNION_CONTACTS_H
#define STARG_MESH_UNION_CONTACTS_H

#include "geometry/bvh.h"
#include "geometry/exact_points.h"
#include "mesh/union/union.h"

typedef struct union_contact {
    uint32_t face[2];
    uint32_t
        end[2]; /* points: the ends of what they share; the same one twice for a single point */
    bool coplanar, overlap; /* in one plane; and with a common area, which has no ends */
} union_contact;

typedef STARG_ARRAY(union_contact) union_contacts;

/* Lists the pairs of which one face is fresh, or all pairs. Errors: MEMORY, CANCELLED, TIME. */
starg_status union_find_contacts(const union_surface *surface, const bvh *tree, bool all,
                                 union_contacts *out);

/* Fills in the ends. `point` gives the number of each vertex of these faces among the points, to
 * which new ones are added. Errors: MEMORY. */
starg_status union_find_ends(const union_surface *surface, const uint32_t *point,
                             exact_points *points, union_contact *contact);

#endif
