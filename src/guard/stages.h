/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of guarding a solid. Each takes finished inputs, which it does not change, and returns
 * one result; only a growing pool is passed along. */
#ifndef STARG_GUARD_STAGES_H
#define STARG_GUARD_STAGES_H

#include "guard/choose.h"
#include "guard/patched.h"
#include "guard/point_coverage.h"
#include "starguard/simplify.h"

/* The request, constant throughout a call. */
typedef struct guard_problem {
    starg_context *context;
    const starg_solid *solid;
    const starg_guard_options *options;
    column_weights weights;
    struct guard_certificate
        *certificate; /* receives the certificate of the bound for all points; NULL: not wanted */
    const struct kept_guards *kept;  /* what the solid's needs were found from; NULL: nothing */
    const candidate_points *carried; /* candidates in place of new ones; NULL: none */
    bool audited; /* the choice is all of the pool, in its order, whose rows are what guards see */
    bool hurried; /* targets that no candidate sees are not looked for in the whole free space */
} guard_problem;

/* Simplified versions of the solid. */
typedef struct guard_detail {
    starg_levels *levels; /* NULL: none wanted, or no time */
    starg_solid *proxy;   /* source of medial axis and skeleton; NULL: the solid */
    bool time_limited;
} guard_detail;

/* Candidates chosen for the solid or for a level of detail. */
typedef struct guard_selection {
    STARG_ARRAY(uint32_t) chosen; /* ordered by what each adds, descending */
    STARG_ARRAY(int) levels;      /* of `chosen`: the first level that chose it */
    STARG_ARRAY(uint32_t) kept;   /* of `chosen`: those that the previous level had chosen */
    int level;                    /* the number of their level */
    size_t lower_bound;
    uint64_t weight_bound; /* upper bound on the weight that max_guards candidates see */
    bool time_limited;     /* it, or its input, was cut short */
} guard_selection;

typedef STARG_ARRAY(starg_guard_level) guard_records;

/* So many guards after so much work. */
typedef struct search_step {
    uint64_t work;
    size_t count;
} search_step;

/* The result of the search over every point. */
typedef struct search_record {
    size_t bound; /* lower bound for guards anywhere; 0: not sought */
    size_t cells, witnesses;
    uint64_t improve_work, prove_work;
    uint64_t weight_bound; /* upper bound on the weight that max_guards guards anywhere see; 0: not
                              sought */
    size_t step_count;
    search_step *steps; /* work in microseconds */
} search_record;

/* What 1, 2, ... candidates see at most, found and bounded, as fractions of the area. */
typedef struct guard_worth {
    size_t count;
    double *seen, *bound;
} guard_worth;

/* Everything that the report of guards needs. */
typedef struct guard_outcome {
    guard_worth worth;
    starg_tour tour;
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

static inline bool guard_wants_part(const starg_guard_options *o) {
    return o->coverage < 1 || o->max_guards > 0;
}

/* Does a search beside the candidates follow the choice among them? */
static inline bool guard_refines(const starg_guard_options *o) {
    return o->method == STARG_GUARD_PILP && o->refine && !guard_wants_part(o) &&
           o->candidates != STARG_CANDIDATES_GIVEN;
}

/* May that search begin with few candidates, and end without bounds beyond those that it needs
 * itself? */
static inline bool guard_is_brief(const starg_guard_options *o) {
    return guard_refines(o) && !o->prove && o->refine_lines == STARG_DEFAULT_LINES &&
           (o->effort == STARG_EFFORT_QUICK || o->effort == STARG_EFFORT_NORMAL);
}

/* The rows of a cover as the choice, with its bounds. Those chosen `before` keep their level, the
 * others get `level`. Errors: MEMORY. */
starg_status selection_of_cover(starg_context *context, const starg_cover *cover,
                                const guard_selection *before, int level, guard_selection *out);
starg_status selection_copy(starg_context *context, const guard_selection *from,
                            guard_selection *out);
void selection_free(guard_selection *selection);

/* Records the guards of a level, the kept ones first. Errors: MEMORY. */
starg_status record_level(const guard_pool *pool, const guard_selection *selection,
                          guard_records *records);
void records_free(starg_context *context, guard_records *records);

/* STARG_GUARD_PILP (guard/progressive.c): the choice for the solid itself, and the records of the
 * coarser levels. Its bounds are 0 if they do not hold for the whole problem. Errors: MEMORY,
 * CANCELLED. */
starg_status progressive_guards(const guard_problem *problem, const guard_detail *detail,
                                const guard_pool *pool, guard_records *records,
                                guard_selection *out);

/* The same choice with the bounds of the whole problem, or a smaller choice found with them.
 * Errors: MEMORY, CANCELLED. */
starg_status bound_guards(const guard_problem *problem, const guard_pool *pool,
                          const guard_selection *first, guard_selection *out);

/* A lower bound for guards anywhere that is free: by parts of the solid (guard/parts_bound.c).
 * Errors: MEMORY, CANCELLED. */
starg_status bound_by_parts(const guard_problem *problem, const guard_pool *pool, size_t *bound);

/* The search over every point of the solid: replaces the choice if it finds fewer guards, which see
 * everything that the old ones saw, and adds points to the pool (guard/search.c). It `improves` the
 * guards, or proves a bound if requested, or both; given candidates stay, and so do the guards
 * chosen from them. The bound in `out` is where it starts. Errors: MEMORY, CANCELLED. */
starg_status search_guards(const guard_problem *problem, const guard_detail *detail, bool improves,
                           guard_pool *pool, guard_selection *selection, search_record *out);

/* If a part suffices: a bound for guards anywhere (guard/search_area.c), which raises that of the
 * choice. Errors: MEMORY, CANCELLED. */
starg_status search_area(const guard_problem *problem, const guard_pool *pool,
                         guard_selection *selection, search_record *out);

/* Of the candidates of a large model, removes points without directions that cannot matter, by what
 * they see of a level of detail (guard/carry.c). Errors: MEMORY, CANCELLED. */
starg_status carry_candidates(const guard_problem *problem, const starg_solid *level,
                              candidate_points *points);

/* Which of these patches, ascending, does no place of the whole free space see where guards may
 * stand, whatever they look at (guard/unseen.c)? *faces counts the faces of which that is certain
 * for all that are listed; `places` receives points that see others. `work` is a budget as that of
 * starg_unseen. Errors: MEMORY, CANCELLED. */
starg_status unseen_prove(starg_context *context, const starg_solid *solid,
                          const starg_guard_options *options, const uint32_t *patches, size_t count,
                          uint64_t work, size_t *faces, candidate_points *places);

/* Everything from the solid to the choice (guard/guard.c). Errors: MEMORY, CANCELLED, those of a
 * solid without candidates. */
starg_status find_guards(const guard_problem *problem, guard_outcome *out);
void outcome_free(starg_context *context, guard_outcome *outcome);

/* Guards of some points, and what they see of all. The pool is of `patched`, so it may not move. */
typedef struct point_round {
    patched_solid patched;
    guard_outcome outcome;
    point_coverage coverage;
    bool complete, any; /* is everything seen, or any part of a face? */
} point_round;

/* The same for every point of the targets (guard/every_point.c); `parts`, if not NULL, are
 * those of faces whose corners have to be seen first. *out is one of the two rounds. */
starg_status find_guards_of_points(const guard_problem *problem, const mesh_patches *parts,
                                   point_round rounds[2], point_round **out);
void point_round_free(starg_context *context, point_round *round);

/* What the chosen guards see of every point. Errors: MEMORY, CANCELLED. */
starg_status find_coverage(const guard_problem *problem, const guard_outcome *outcome,
                           point_coverage *out);

/* What guards of a result see of the patches of their scene (guard/see.c). Errors: those of
 * starg_visibility. */
starg_status guards_look(starg_context *context, const starg_solid *scene,
                         const starg_guards *guards, patched_solid *patched, starg_bits **rows);

/* The patches of the model as a mesh: the vertices of the scene, then the points. Errors: MEMORY.
 */
starg_status guards_draw(starg_context *context, const patched_solid *patched, starg_mesh **out);

/* Finds the worth, if the options ask for it (guard/curve.c). Errors: MEMORY, CANCELLED. */
starg_status curve_find(const guard_problem *problem, guard_outcome *outcome);

/* If the options ask for it, puts the chosen guards in the order of a short tour and finds the way
 * (guard/tour.c). Guards that stay are no part of it, and the time limit does not end it. Errors:
 * MEMORY, CANCELLED. */
starg_status tour_find(const guard_problem *problem, guard_outcome *outcome);

/* The result: what the chosen guards see, recomputed (guard/measure.c). Takes the records over.
 * Errors: MEMORY, CANCELLED. */
starg_status report_guards(const guard_problem *problem, guard_outcome *outcome,
                           const point_coverage *coverage, starg_guards **out);

#endif
