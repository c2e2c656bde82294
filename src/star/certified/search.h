/* SPDX-License-Identifier: Apache-2.0 */
/* What makes and changes a partition: starts, searches for fewer pieces, better places at the end.
 * Each is a file of its own; certified.c calls them in this order. */
#pragma once

#include "core/rng.h"
#include "star/certified/partition.h"

/* ---- a plane that makes a region easier to see (split_plane.c) ---- */

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

/* ---- the first pieces: cuts by planes until each is star-shaped (bsp_start.c) ---- */

typedef struct bsp_options {
    uint64_t stream;      /* of random numbers: another one gives another result */
    size_t budget;        /* evaluations of open pieces, after which it is given up */
    bool to_the_end;      /* neither budget nor time end it; once the time is over, it hurries */
    const double *guards; /* guard_count x 3, or NULL: places to choose guards from */
    size_t guard_count;
    const uint32_t *pieces; /* those to be cut, or NULL: all */
    size_t piece_count;
} bsp_options;

typedef struct bsp_report {
    bool done;     /* else the partition is of no use */
    uint64_t work; /* vertices, facets and rows looked at */
} bsp_report;

/* Cuts pieces of a partition, whose guards need not see anything, until each has a certified guard.
 * The stamps of pieces that are not cut stay. Errors: MEMORY, CANCELLED. */
starg_status bsp_start(partition *p, const bsp_options *options, bsp_report *report);

/* ---- making pieces fewer (improve.c) ---- */

enum { IMPROVE_SORTS = 8 };

/* What trials of each sort have cost and brought lately. All zero at first. */
typedef struct improve_tally {
    double work, trials, saved;
    double due; /* when the next one is */
} improve_tally;
typedef struct improve_tallies {
    improve_tally of[IMPROVE_SORTS];
} improve_tallies;

typedef struct improve_options {
    uint64_t trials; /* to be made at most                             */
    uint64_t work;   /* likewise, in vertices, facets and rows looked at; whole batches are made */
    uint64_t patience;        /* trials that save nothing, after which the search ends */
    size_t enough;            /* stop when there are no more pieces than that   */
    uint64_t first;           /* number of the first trial: others try other things */
    uint64_t since;           /* unions contain a piece with a later stamp */
    improve_tallies *tallies; /* are read and kept up */
} improve_options;

typedef struct improve_report {
    uint64_t trials, work, joins, saved, moves; /* saved: pieces, but for joins */
    bool time_limited;
} improve_report;

/* Joins neighbours whose union is star-shaped, until there are none or the time is over. Errors:
 * MEMORY, CANCELLED. */
starg_status improve_join(partition *p);

/* Joins pieces whose union is star-shaped and cuts unions again into fewer pieces, until no trial
 * helps for long, or the trials, the work or the time are used up. The partition is valid at all
 * times. Errors: MEMORY, CANCELLED. */
starg_status improve(partition *p, const improve_options *options, improve_report *report);

/* ---- cutting some neighbouring pieces anew (ruin_recreate.c) ---- */

typedef struct ruin_recreate_options {
    uint64_t trials, work; /* of the search in what is cut anew, at most */
    uint64_t round;        /* number of it: others try other things      */
    improve_tallies *tallies;
} ruin_recreate_options;

typedef struct ruin_recreate_report {
    uint64_t trials, work;
    bool better; /* there are fewer pieces */
    bool time_limited;
} ruin_recreate_report;

/* Joins some pieces of a partition with an index, cuts their union from scratch and searches what
 * has become of it; the partition is as it was if that gives more pieces than before. Errors:
 * MEMORY, CANCELLED. */
starg_status ruin_recreate(partition *p, const ruin_recreate_options *options,
                           ruin_recreate_report *report);

/* ---- borders of several planes around what one of some guards sees (separator.c) ---- */

/* Triangles of a region, by number. */
typedef STARG_ARRAY(uint32_t) separator_triangles;

/* Triangles that must be on the first guard's side of a border, or on that of all other guards. */
typedef struct separator_task {
    const region *r;
    const double (*guards)[3];
    size_t guard_count;
    separator_triangles own, others;
    double gap; /* that planes keep to guards and triangles, in unit coordinates */
} separator_task;

/* Looks for a border and appends the part to the plan, or leaves that as it was. What is found is
 * rounded: to be proven on the cut mesh. Errors: MEMORY. */
starg_status separator_find(const separator_task *task, starg_rng *rng, region_scratch *scratch,
                            cut_plan *plan, bool *found);

/* Is a triangle wholly in one of the plan's parts, and in a single term? */
bool separator_holds(const region *r, const cut_plan *plan, uint32_t triangle);

/* How many pairs of an own triangle and another one have cones from their guards that meet: while
 * there are any, there is no border. Counting ends at `most`. Errors: MEMORY. */
starg_status crossings_count(const separator_task *task, size_t most, region_scratch *scratch,
                             size_t *count);

/* ---- guards that see all of a region, and borders between their parts (guard_split.c) ---- */

enum { GUARD_SPLIT_MOST = 4 };

typedef struct guard_split_options {
    double margin;             /* that guards keep to all planes, in unit coordinates */
    const double (*starts)[3]; /* places in the region */
    size_t start_count;        /* at least one */
} guard_split_options;

/* Looks for `guards` (2 to GUARD_SPLIT_MOST) star-shaped parts. What is found is rounded:
 * to be proven on the cut mesh. Errors: MEMORY. */
starg_status guard_split_find(const region *r, size_t guards, const guard_split_options *options,
                              starg_rng *rng, region_scratch *scratch, cut_plan *plan, bool *found);

/* ---- planes that cut a region into a given number of star-shaped parts (repartition.c) ---- */

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

/* ---- labels for nodes such that those across an edge go together (labelling.c) ---- */

/* Labels are bits of a set. */
typedef uint32_t label_set;
enum { LABELLING_MOST = 32 };

/* Different labels may be at its two ends if each is one of those that fit there. No label fits at
 * both ends. */
typedef struct labelling_edge {
    uint32_t nodes[2];
    label_set fits[2];
} labelling_edge;

/* Every node has three edges. The lists are filled by the caller, then labelling_prepare is called;
 * the fits and `given` may change between solutions. */
typedef struct labelling {
    starg_context *context;
    STARG_ARRAY(label_set) given; /* of each node: those it may have */
    STARG_ARRAY(labelling_edge) edges;
    /* Where nothing else decides, a high rank is preferred; labels of rank 0 are for nodes that no
     * other is left for. */
    double ranks[LABELLING_MOST];

    STARG_ARRAY(label_set) left;    /* of each node; of a solution: exactly one */
    label_set ranked;               /* those with a rank above 0 */
    STARG_ARRAY(uint32_t) edges_of; /* node x 3 */
    STARG_ARRAY(uint32_t) queue;
    STARG_ARRAY(uint32_t) changed; /* nodes and what they had before, to go back */
} labelling;

void labelling_free(labelling *l);

/* Errors: MEMORY. */
starg_status labelling_prepare(labelling *l);

/* *found is false when there is no solution, and sometimes when there is one that is hard to find.
 * Another state of `rng` gives another solution. Errors: MEMORY. */
starg_status labelling_solve(labelling *l, starg_rng *rng, bool *found);

/* ---- a way to share out pieces among their neighbours (reassign.c) ---- */

typedef struct reassign_task {
    const uint32_t *pieces; /* connected; at most FAN_PIECES_MOST */
    size_t piece_count;
    size_t
        kept; /* so many are made anew within their union; below piece_count, or 1 of 1: a move */
    const uint32_t *neighbours; /* of the pieces */
    size_t neighbour_count;
    double margin; /* that guards keep to all planes, in unit coordinates */
} reassign_task;

/* Looks for a way to share out pieces of a partition with an index among some of their neighbours
 * and the kept ones. A move must make pieces more uneven. What is found is rounded: to be proven on
 * the mesh. Errors: MEMORY. */
starg_status reassign_find(const partition *p, const reassign_task *task, starg_rng *rng,
                           region_scratch *scratch, fan_plan *plan, bool *found);

/* ---- how flat the tetrahedra between guards and facets are (widen.c) ---- */

/* Tetrahedra with a dihedral angle below this many degrees are flat, and pieces with a margin below
 * the other one have little room: the radius of the ball around the guard by the diagonal of the
 * piece's bounding box. */
#define FLATNESS_ANGLE  0.2
#define FLATNESS_MARGIN 2e-3

/* A piece, facet or entry of an index, and what it lacks; and the order for qsort that begins with
 * what lacks most. */
typedef struct flatness_rank {
    double lack;
    uint32_t number;
} flatness_rank;

int flatness_compare(const void *x, const void *y);

/* What the smallest dihedral angles of the tetrahedra on a facet lack in all, 0 if nothing;
 * infinite if the guard of a piece at the facet is not strictly inside. */
double flatness_of_facet(const partition *p, const facet *f);

/* The same for one side of the facet, which is not the outside. */
double flatness_of_side(const partition *p, const facet *f, int side);

/* Of the bounding box of a piece, in unit coordinates; the partition has an index. */
double flatness_diagonal(const partition *p, uint32_t number);

/* How far its guard is from the nearest plane of its facets; likewise. */
double flatness_room(const partition *p, uint32_t number);

/* What angles and the margin of a piece lack, 0 if nothing; likewise. */
double flatness_of_piece(const partition *p, uint32_t number);

/* The same for all angles, and the margins of the first pieces; without an index. */
double flatness_of_first(const partition *p, size_t count);

/* ---- room for guards (widen.c) ---- */

/* Cuts pairs of neighbours anew, so that the smallest balls in
 * kernels and the smallest angles grow; `work` bounds the vertices, facets and rows visited. Stops
 * when time runs out. Errors: MEMORY, CANCELLED. */
starg_status widen(partition *p, uint64_t work);

/* ---- better triangles in the borders between pieces (refine_caps.c) ---- */

/* Adds vertices within plane borders between two pieces where the tetrahedra on them have small
 * dihedral angles, and triangulates these borders anew. Pieces and guards stay the same. Errors:
 * MEMORY. */
starg_status refine_caps(partition *p);

/* ---- better tetrahedra by small changes (reshape.c) ---- */

/* Moves guards and vertices that cuts have made, merges such vertices with others, and swaps edges,
 * where angles lack less then (widen.c). No margin gets smaller unless it
 * stays above half of FLATNESS_MARGIN. Ends when `work` (64 for each look at a facet) is done or
 * time is over. Rebuilds the index. Errors: MEMORY, CANCELLED. */
starg_status reshape(partition *p, uint64_t work);
