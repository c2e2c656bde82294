/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of guarding a solid. Each takes finished inputs, which stay as they are, and returns
 * one result; only a pool that grows is handed over. */
#ifndef STARG_GUARD_STAGES_H
#define STARG_GUARD_STAGES_H

#include "guard/choose.h"
#include "starguard/simplify.h"

/* What is asked for, all through a call. */
typedef struct guard_problem {
    starg_context *context;
    const starg_solid *solid;
    const starg_guard_options *options;
    column_weights weights;
    struct guard_certificate
        *certificate; /* to be made of the bound for all points; NULL: not wanted */
} guard_problem;

/* Simpler versions of the solid. */
typedef struct guard_detail {
    starg_levels *levels; /* NULL: none are wanted, or there was no time                       */
    starg_solid *proxy;   /* what medial axis and skeleton are taken from; NULL: the solid     */
    bool time_limited;
} guard_detail;

/* Candidates that are chosen for the solid or for a level of detail. */
typedef struct guard_selection {
    STARG_ARRAY(uint32_t) chosen; /* the one that adds most first                              */
    STARG_ARRAY(int) levels;      /* of `chosen`: the one that first asked for it              */
    STARG_ARRAY(uint32_t) kept;   /* of `chosen`: those that the level before had chosen       */
    int level;                    /* what they are for: its number                             */
    size_t lower_bound;
    uint64_t weight_bound; /* no max_guards candidates see more                                */
    bool time_limited;     /* this, or what it was made from, was cut short                    */
} guard_selection;

typedef STARG_ARRAY(starg_guard_level) guard_records;

/* What the search over every point has come to. */
typedef struct search_record {
    size_t bound; /* no fewer guards do, wherever they stand; 0: not sought */
    size_t cells, witnesses;
    uint64_t improve_work, prove_work;
    uint64_t weight_bound; /* no max_guards guards see more, wherever they stand; 0: not sought */
} search_record;

/* What guards are reported from. */
typedef struct guard_outcome {
    guard_pool pool;
    guard_selection selection;
    guard_records records; /* of the levels */
    search_record search;
} guard_outcome;

static inline candidate_shape guard_shape(const guard_problem *problem,
                                          const guard_detail *detail) {
    const starg_solid *proxy = detail->proxy != NULL ? detail->proxy : problem->solid;
    return (candidate_shape){problem->solid, proxy, problem->options->clearance};
}

/* A cover's rows as the chosen ones, with its bounds. Those that were chosen `before` keep their
 * level, the others get `level`. Errors: MEMORY. */
starg_status selection_of_cover(starg_context *context, const starg_cover *cover,
                                const guard_selection *before, int level, guard_selection *out);
starg_status selection_copy(starg_context *context, const guard_selection *from,
                            guard_selection *out);
void selection_free(starg_context *context, guard_selection *selection);

/* Writes down the guards of a level, the kept ones first. Errors: MEMORY. */
starg_status record_level(const guard_pool *pool, const guard_selection *selection,
                          guard_records *records);
void records_free(starg_context *context, guard_records *records);

/* STARG_GUARD_PILP (guard/progressive.c): the choice for the solid itself, and the records of the
 * levels before. Its bounds are 0 where it is not of the whole problem. Errors: MEMORY, CANCELLED.
 */
starg_status progressive_guards(const guard_problem *problem, const guard_detail *detail,
                                const guard_pool *pool, guard_records *records,
                                guard_selection *out);

/* The same choice with the bounds of the whole problem, or a smaller one that they come with.
 * Errors: MEMORY, CANCELLED. */
starg_status bound_guards(const guard_problem *problem, const guard_pool *pool,
                          const guard_selection *first, guard_selection *out);

/* The search over every point of the solid: replaces the choice by fewer guards where it finds
 * them, which see all that the former ones saw, and adds points to the pool (guard/search.c). It
 * only `improves` the guards, or goes on to prove a bound where that is asked for, or both; given
 * candidates stay, and so do the guards that are chosen of them. Errors: MEMORY, CANCELLED. */
starg_status search_guards(const guard_problem *problem, const guard_detail *detail, bool improves,
                           guard_pool *pool, guard_selection *selection, search_record *out);

/* Where a part is enough: a bound for guards anywhere (guard/search_area.c). Raises that of the
 * choice to it. Errors: MEMORY, CANCELLED. */
starg_status search_area(const guard_problem *problem, const guard_pool *pool,
                         guard_selection *selection, search_record *out);

/* The result: what the chosen guards see, counted anew (guard/measure.c). Takes the records over.
 * Errors: MEMORY, CANCELLED. */
starg_status report_guards(const guard_problem *problem, guard_outcome *outcome,
                           starg_guards **out);

#endif
