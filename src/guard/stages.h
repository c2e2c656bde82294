/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of guarding a solid. Each takes finished inputs, which it does not change, and returns
 * one result; only a growing pool is passed along. */
#pragma once

#include "core/fields.h"
#include "core/memory.h"
#include "guard/candidates.h"
#include "mesh/solid.h"
#include "starguard/cover.h"
#include "starguard/guard.h"
#include "starguard/simplify.h"
#include "starguard/visibility.h"

/* ---- a solid whose faces are seen in parts (patched.c) ---- */

/* `solid` is a copy that borrows everything but the patches, which it has if faces are cut. */
typedef struct patched_solid {
    starg_solid solid;
    mesh_patches *patches;
} patched_solid;

/* Cuts the faces as the options say; view->patch becomes the largest length of an edge, or
 * STARG_PATCH_OFF where auto leaves the faces whole. Errors: ARGUMENT (too many parts), MEMORY. */
starg_status patched_solid_make(starg_context *context, const starg_solid *solid,
                                starg_visibility_options *view, patched_solid *out);
void patched_solid_free(patched_solid *patched);

/* ---- the request, and what stages return (guard.c) ---- */

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

static inline void problem_free(guard_problem *problem) {
    column_weights_free(&problem->weights);
}

/* What is found of the solid before anything is seen. */
typedef struct guard_detail {
    starg_levels *levels;     /* simplified versions; NULL: none wanted, or no time */
    starg_solid *proxy;       /* source of medial axis and skeleton; NULL: the solid */
    candidate_points first;   /* candidates before augmentation */
    candidate_points centres; /* on the medial axis: further places of the search */
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

/* Does it look for guards, or for a bound? */
static inline bool guard_searches(const starg_guard_options *o) {
    return !guard_wants_part(o) && (guard_refines(o) || o->prove);
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

/* Everything from the solid to the choice (guard/guard.c). Errors: MEMORY, CANCELLED, those of a
 * solid without candidates. */
starg_status find_guards(const guard_problem *problem, guard_outcome *out);
void outcome_free(guard_outcome *outcome);

/* ---- guards that stay, faces that several must see: what is left for others (keep.c) ---- */

typedef struct kept_guards {
    candidate_points poses;
    starg_bits *rows; /* what they see, by column; NULL: there are none */
    uint32_t *need;   /* by column: how many others must see it */
    size_t open;      /* number of columns that others must see */
    uint32_t times;   /* the largest need */
    bool even;        /* all that others must see, they must see as often */
    uint64_t weight;  /* of the columns that need no others */
} kept_guards;

/* Are there such guards, or such faces? */
bool keep_applies(const guard_problem *problem);

/* Of a problem with all columns as targets. Errors: MESH (a guard that is not in the free
 * space), ARGUMENT (requests that exclude each other, a guard that looks nowhere), MEMORY,
 * CANCELLED. */
starg_status keep_find(const guard_problem *problem, kept_guards *out);
void keep_free(kept_guards *kept);

/* The same for what is asked of the others, once it is known. Errors: ARGUMENT. */
starg_status keep_check(const guard_problem *problem, const kept_guards *kept);

/* ---- of the candidates of a large model, those that may matter (carry.c) ---- */

/* Of the candidates of a large model, removes points without directions that cannot matter, by what
 * they see of a level of detail (guard/carry.c). Errors: MEMORY, CANCELLED. */
starg_status carry_candidates(const guard_problem *problem, const starg_solid *level,
                              candidate_points *points);

/* ---- the cover problem of a pool (choose.c) ---- */

STARG_DROP(starg_cover, starg_cover)

/* What a stage asks of the cover. */
typedef struct choice {
    starg_cover_method method;
    size_t max_nodes;
    const uint32_t *given; /* candidates that are already chosen */
    size_t given_count;
    bool prices;
} choice;

/* The weight that must be seen: UINT64_MAX for all that can be. */
uint64_t choose_target(const guard_pool *pool, const column_weights *weights);

/* Chooses candidates of a non-empty pool: as many as the options' coverage, redundancy and limit
 * require. Errors: MEMORY, CANCELLED. */
starg_status choose_candidates(const guard_pool *pool, const column_weights *weights,
                               const choice *how, starg_cover **out);

/* ---- the choice, from a coarse level to the model itself (progressive.c) ---- */

/* Records the guards of a level, the kept ones first. Errors: MEMORY. */
starg_status record_level(const guard_pool *pool, const guard_selection *selection,
                          guard_records *records);

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

/* ---- two guards at least a baseline apart for each face (baseline.c) ---- */

/* Are p and q, as seen from the centroid of the patch, at least the angle with this cosine apart?
 */
bool baseline_holds(const starg_solid *solid, size_t patch, double cosine, const double p[3],
                    const double q[3]);

/* Adds candidates to a choice until two guards at least the baseline apart see each face, as far as
 * candidates allow, then removes guards that are no longer needed. Does nothing without a baseline.
 * Errors: MEMORY, CANCELLED. */
starg_status baseline_guards(const guard_problem *problem, const guard_pool *pool,
                             guard_selection *selection);

/* ---- bounds for guards anywhere (parts_bound.c, search_area.c) ---- */

/* A lower bound for guards anywhere that is free: by parts of the solid (guard/parts_bound.c).
 * Errors: MEMORY, CANCELLED. */
starg_status bound_by_parts(const guard_problem *problem, const guard_pool *pool, size_t *bound);

/* If a part suffices: a bound for guards anywhere (guard/search_area.c), which raises that of the
 * choice. Errors: MEMORY, CANCELLED. */
starg_status search_area(const guard_problem *problem, const guard_pool *pool,
                         guard_selection *selection, search_record *out);

/* ---- the search over every point of the solid (search.c) ---- */

/* The search over every point of the solid: replaces the choice if it finds fewer guards, which see
 * everything that the old ones saw, and adds points to the pool (guard/search.c). It `improves` the
 * guards, or proves a bound if requested, or both; given candidates stay, and so do the guards
 * chosen from them. The bound in `out` is where it starts. Errors: MEMORY, CANCELLED. */
starg_status search_guards(const guard_problem *problem, const guard_detail *detail, bool improves,
                           guard_pool *pool, guard_selection *selection, search_record *out);

/* ---- which patches no place of the free space sees (unseen.c) ---- */

/* Which of these patches, ascending, does no place of the whole free space see where guards may
 * stand, whatever they look at (guard/unseen.c)? *faces counts the faces of which that is certain
 * for all that are listed; `places` receives points that see others. `work` is a budget as that of
 * starg_unseen. Errors: MEMORY, CANCELLED. */
starg_status unseen_prove(starg_context *context, const starg_solid *solid,
                          const starg_guard_options *options, const uint32_t *patches, size_t count,
                          uint64_t work, size_t *faces, candidate_points *places);

/* ---- what fewer candidates see, and a tour of the guards (curve.c, tour.c) ---- */

/* Finds the worth, if the options ask for it (guard/curve.c). Errors: MEMORY, CANCELLED. */
starg_status curve_find(const guard_problem *problem, guard_outcome *outcome);

/* If the options ask for it, puts the chosen guards in the order of a short tour and finds the way
 * (guard/tour.c). Guards that stay are no part of it, and the time limit does not end it. Errors:
 * MEMORY, CANCELLED. */
starg_status tour_find(const guard_problem *problem, guard_outcome *outcome);

/* ---- do guards together see every point of the targets? (point_coverage.c) ---- */

/* What is known of points. */
typedef struct point_coverage {
    double *share; /* by guard and face, guard by guard: of the face's area, the parts that it is
                      the first to see whole */
    double *open;  /* by face: the share that is not decided */
    face_points unseen; /* points that no guard sees, a few of each face */
} point_coverage;

/* `count` guards as in starg_visibility; `view` has their directions. Errors: MEMORY, CANCELLED. */
starg_status point_coverage_find(starg_context *context, const starg_solid *solid,
                                 const double *guards, size_t count,
                                 const starg_visibility_options *view, point_coverage *out);
void point_coverage_free(point_coverage *coverage);

/* ---- guards of every point of the targets (every_point.c) ---- */

/* What the chosen guards see of every point. Errors: MEMORY, CANCELLED. */
starg_status find_coverage(const guard_problem *problem, const guard_outcome *outcome,
                           point_coverage *out);

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
void point_round_free(point_round *round);

/* ---- the result (measure.c) ---- */

/* The result: what the chosen guards see, recomputed (guard/measure.c). Takes the records over.
 * Errors: MEMORY, CANCELLED. */
starg_status report_guards(const guard_problem *problem, guard_outcome *outcome,
                           const point_coverage *coverage, starg_guards **out);

/* ---- what guards of a result see of the patches of their scene (see.c) ---- */

/* What guards of a result see of the patches of their scene (guard/see.c). Errors: those of
 * starg_visibility. */
starg_status guards_look(starg_context *context, const starg_solid *scene,
                         const starg_guards *guards, patched_solid *patched, starg_bits **rows);

/* The patches of the model as a mesh: the vertices of the scene, then the points. Errors: MEMORY.
 */
starg_status guards_draw(starg_context *context, const patched_solid *patched, starg_mesh **out);

/* ---- the same as numbers for tables (tables.c) ---- */

enum { SEEN_TIMES = 3 };

/* A scene, in the patches in which the guards see it, and a row of patches for each guard. */
typedef struct seen_table {
    const starg_guards *guards;
    const starg_face_groups *groups; /* NULL: the faces have none */
    patched_solid patched;
    starg_bits *rows;
} seen_table;

/* Errors: those of starg_visibility. */
starg_status seen_table_open(starg_context *context, const starg_solid *scene,
                             const starg_guards *guards, const starg_face_groups *groups,
                             seen_table *out);
void seen_table_close(seen_table *table);

typedef struct seen_face {
    double area, share; /* the latter: of the area, that any guard sees */
    size_t cameras;     /* that see some of it */
    size_t least;       /* that see every part of it, at least */
} seen_face;

/* `sees`: by guard, whether it sees some of the face. */
seen_face seen_table_face(const seen_table *table, size_t face, uint8_t *sees);

typedef struct seen_area {
    double all, alone; /* areas: seen, and seen by no other guard */
    double density;    /* mean by area, of pixels for each unit of length; 0: not known */
} seen_area;

typedef struct group_area {
    double all, by[SEEN_TIMES]; /* areas, by[k] of what k + 1 guards see */
} group_area;

/* An area for each guard, and for each group; the last of these, one more than there are groups, is
 * that of all targets. */
void seen_table_measure(const seen_table *table, seen_area *guards, group_area *groups);

/* A part of an area, at most 1. */
double seen_ratio(double part, double all);

/* ---- field tables of guard options and of GUARDS.json (guards_fields.c) ---- */

/* The whole file as a starg_guards. */
extern const starg_fields guards_file_fields;
