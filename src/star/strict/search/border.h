/* SPDX-License-Identifier: Apache-2.0 */
/* A border of several planes around what one of some guards sees. */
#ifndef STARG_STAR_STRICT_SEARCH_BORDER_H
#define STARG_STAR_STRICT_SEARCH_BORDER_H

#include "core/rng.h"
#include "star/strict/search/parting.h"

enum { BORDER_PLANES_MOST = 64 };

typedef enum border_end { BORDER_GOES_ON, BORDER_ENDS_TERM, BORDER_ENDS_PART } border_end;

/* Part after part, each cut from what the former ones leave, which is the last part in the end. A
 * part is the union of terms, a term what is below all of its planes. */
typedef struct border_plan {
    int count;
    partition_plane planes[BORDER_PLANES_MOST];
    border_end ends[BORDER_PLANES_MOST]; /* is it the last one of its term, or part? */
} border_plan;

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
                         border_plan *plan, bool *found);

/* Is a triangle wholly in one of the plan's parts, and in a single term? */
bool border_holds(const region *r, const border_plan *plan, uint32_t triangle);

#endif
