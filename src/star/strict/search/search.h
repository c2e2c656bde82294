/* SPDX-License-Identifier: Apache-2.0 */
/* Searches for cuts of a region, and for ways to share out pieces. Each file of this folder but
 * improve.c and renew.c is one of them. */
#pragma once

#include "core/rng.h"
#include "star/strict/partition/apply.h"

/* ---- a plane between two sets of triangles and their guards (parting.c) ---- */

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

/* ---- a border of several planes around what one of some guards sees (border.c) ---- */

/* Triangles that must be on the first guard's side of a border, or on that of all other guards. */
typedef struct border_task {
    const region *r;
    const double (*guards)[3];
    size_t guard_count;
    parting_triangles own, others;
    double gap; /* that planes keep to guards and triangles, in unit coordinates */
} border_task;

/* For planes between triangles of a task. */
static inline parting border_parting(const border_task *task, region_scratch *scratch) {
    return (parting){.r = task->r,
                     .guards = task->guards,
                     .guard_count = task->guard_count,
                     .gap = task->gap,
                     .scratch = scratch};
}

/* Looks for a border and appends the part to the plan, or leaves that as it was. What is found is
 * rounded: to be proven on the cut mesh. Errors: MEMORY. */
starg_status border_find(const border_task *task, starg_rng *rng, region_scratch *scratch,
                         cut_plan *plan, bool *found);

/* Is a triangle wholly in one of the plan's parts, and in a single term? */
bool border_holds(const region *r, const cut_plan *plan, uint32_t triangle);

/* ---- cones that meet, where there is no border (crossings.c) ---- */

/* How many pairs of an own triangle and another one have cones from their guards that meet: while
 * there are any, there is no border. Counting ends at `most`. Errors: MEMORY. */
starg_status crossings_count(const border_task *task, size_t most, region_scratch *scratch,
                             size_t *count);

/* ---- a few guards that see all of a region, and the borders between their parts (covering.c) ----
 */

enum { COVERING_MOST = 4 };

typedef struct covering_options {
    double margin;             /* that guards keep to all planes, in unit coordinates */
    const double (*starts)[3]; /* places in the region */
    size_t start_count;        /* at least one */
} covering_options;

/* Looks for `guards` (2 to COVERING_MOST) star-shaped parts. What is found is rounded:
 * to be proven on the cut mesh. Errors: MEMORY. */
starg_status covering_find(const region *r, size_t guards, const covering_options *options,
                           starg_rng *rng, region_scratch *scratch, cut_plan *plan, bool *found);

/* ---- repartition: the search for planes that cut a region into a given number of star-shaped
 * parts (repartition.c) ---- */

typedef struct repartition_options {
    double margin;  /* that guards keep to all planes, in unit coordinates            */
    int directions; /* random ones tried for each cut                                 */
    int steps;      /* of the climb from each of the best                             */
    bool anywhere;  /* take a place for the last cut by chance, not the roomiest      */
} repartition_options;

/* Looks for `parts` (1 to APPLY_MOST) parts, each below one plane; adds the planes to the plan.
 * What is found is rounded: to be proven on the cut mesh. Errors: MEMORY. */
starg_status repartition_find(const region *r, int parts, const repartition_options *options,
                              starg_rng *rng, region_scratch *scratch, cut_plan *plan, bool *found);

/* ---- planes of reflex edges (reflex_plane.c) ---- */

/* A plane through a reflex edge of a region, such that no side has a reflex edge there; or through
 * an edge in which the region's surface touches itself. *found is false when there is no such edge:
 * the region is convex up to rounding, or in parts that are. Errors: MEMORY. */
starg_status reflex_plane_find(const region *r, starg_rng *rng, region_scratch *scratch,
                               partition_plane *plane, bool *found);

/* ---- split-plane search: a plane that makes a region easier to see (split_plane.c) ---- */

/* What will do. */
typedef enum split_plane_demand {
    SPLIT_PLANE_GAIN, /* a plane such that two guards miss less than one  */
    SPLIT_PLANE_FAIR, /* if none gains, the best of those with fair shares */
    SPLIT_PLANE_HALVE /* any plane with fair shares                        */
} split_plane_demand;

typedef struct split_plane_options {
    double margin; /* that guards keep to all planes, in unit coordinates */
    int effort;    /* so many times the usual tries; 0: few of them       */
    split_plane_demand demand;
    const double *places; /* more places to choose guards from */
    size_t place_count;
} split_plane_options;

/* Looks for a plane such that one guard below it and one above it miss less of the region than any
 * single guard does. Nothing is proven. Errors: MEMORY. */
starg_status split_plane_find(const region *r, const split_plane_options *options, starg_rng *rng,
                              region_scratch *scratch, partition_plane *plane, bool *found);

/* ---- piece elimination: the search for a way to share out pieces among their neighbours
 * (eliminate.c) ---- */

typedef struct eliminate_task {
    const uint32_t *pieces; /* connected; at most FAN_PIECES_MOST */
    size_t piece_count;
    size_t
        kept; /* so many are made anew within their union; below piece_count, or 1 of 1: a move */
    const uint32_t *neighbours; /* of the pieces */
    size_t neighbour_count;
    double margin; /* that guards keep to all planes, in unit coordinates */
} eliminate_task;

/* Looks for a way to share out pieces of a partition with an index among some of their neighbours
 * and the kept ones. A move must make pieces more uneven. What is found is rounded: to be proven on
 * the mesh. Errors: MEMORY. */
starg_status eliminate_find(const partition *p, const eliminate_task *task, starg_rng *rng,
                            region_scratch *scratch, fan_plan *plan, bool *found);
