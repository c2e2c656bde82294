/* SPDX-License-Identifier: Apache-2.0 */
/* A plane between two sets of triangles and their guards. */
#ifndef STARG_STAR_STRICT_SEARCH_PARTING_H
#define STARG_STAR_STRICT_SEARCH_PARTING_H

#include "star/strict/partition/partition.h"

enum { PARTING_TOUCHED_MOST = 3 };

/* Triangles of a region, by number. */
typedef STARG_ARRAY(uint32_t) parting_triangles;
typedef STARG_ARRAY(double) parting_points;

typedef struct parting {
    const region *r;
    const double (*guards)[3]; /* the first one is below, all others above */
    size_t guard_count;
    double gap; /* that planes keep to guards and triangles, in unit coordinates */
    region_scratch *scratch;

    /* of the current pair of sets */
    parting_points low, high;
    parting_triangles marks; /* by vertex; all zero between calls */
    uint32_t touched[PARTING_TOUCHED_MOST];
    int touched_count; /* may be larger: then there is no plane */
} parting;

static inline const double *parting_vertex(const region *r, uint32_t triangle, int k) {
    return r->vertices.data + 3 * (size_t)r->triangles.data[triangle].corners[k];
}

/* Looks for a plane with the first guard and `low` below, the other guards and `high` above.
 * Errors: MEMORY. */
starg_status parting_find(parting *p, const parting_triangles *low, const parting_triangles *high,
                          partition_plane *out, bool *found);

void parting_free(parting *p);

#endif
